// A shared library without an entry point.
int nothing_to_see();
int nothing_to_see() { return 0; }
