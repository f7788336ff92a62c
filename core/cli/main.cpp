// The pcmlab command; commands.cpp lists what it can do.
#include "pcm/cli/commands.h"

int main(int argc, char** argv)
{
    return pcm::cli::run_program("pcmlab", "Out-of-core point clouds", pcm::cli::commands(), argc, argv);
}
