// For a plugin that asks the dynamic linker for a function that nobody has.
void pcm_that_is_nowhere();

void (*asked)() = pcm_that_is_nowhere;
