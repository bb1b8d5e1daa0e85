// Test library that is no plugin: it exports another function.
extern "C" int some_other_library();
extern "C" int some_other_library() { return 1; }
