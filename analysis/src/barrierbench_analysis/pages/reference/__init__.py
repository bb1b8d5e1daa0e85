"""docs/reference: pages of settings, fields, verbs and kinds of eval, made from what the program prints."""

MARK = "<!-- written by ./bench dev readme --reference -->"  # second line of every page that is made here
