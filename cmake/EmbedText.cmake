# cmake -DTEXT=file -DNAME=symbol -DOUT=file.cpp -P EmbedText.cmake: a text as a string of C++.
file(READ "${TEXT}" text)
file(WRITE "${OUT}" "extern const char ${NAME}[];\nconst char ${NAME}[] = R\"embedded(${text})embedded\";\n")
