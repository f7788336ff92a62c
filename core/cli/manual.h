// "pcmlab manual": the manual that is installed with the command.
#pragma once

namespace pcm::cli {

// Prints the path of the manual's first page, and opens it where there is a display and a program for it. Returns the
// exit code: 1 where no manual is installed, with a message of how to get one.
int show_manual();

}  // namespace pcm::cli
