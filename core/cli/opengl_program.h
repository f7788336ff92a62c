// pcmlab-render, the program that runs what needs OpenGL: pcmlab itself loads no OpenGL, and starts it where a command
// needs it. It lies next to pcmlab and takes the same command lines.
#pragma once

#include <string>
#include <vector>

namespace pcm::cli {

// Replaces this process. `words`: the command's name and what follows it. Throws Error(not_found) when the program is
// missing.
[[noreturn]] void start_opengl_program(std::vector<std::string> words);

}  // namespace pcm::cli
