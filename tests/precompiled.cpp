// Does nothing: the target of this file owns the precompiled header that the unit tests share (CMakeLists.txt).
int main() {}
