// Nothing: the target of this file owns the precompiled header that the plugins share (CMakeLists.txt).
