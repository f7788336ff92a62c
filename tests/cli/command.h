// Runs the pcmlab command.
#pragma once

#include "tests/clouds.h"
#include "tests/paths.h"
#include "tests/support.h"

#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace pcm::test {

using Json = nlohmann::json;

struct Result {
    int code = -1;
    std::string out, err;
};

// Skips a test that draws where nothing can be drawn: `result` is of a first try.
#define PCM_REQUIRE_DRAWING(result) \
    if ((result).err.find("no OpenGL context") != std::string::npos) GTEST_SKIP() << (result).err

class CommandTest : public testing::Test {
protected:
    // Runs pcmlab with `arguments`, which the caller quotes for the shell; `before` is what the shell is given first.
    Result pcmlab(const std::string& arguments, const std::string& before = {})
    {
        const std::filesystem::path err = folder_ / "stderr.txt";
        const std::string command = before + " '" + paths::command + "' " + arguments + " 2>'" + err.string() + "'";
        // What draws has no search for leaks under the address sanitizer: it crashes now and then while a software
        // renderer's threads end. Other sanitizers do not read this.
        if (arguments.rfind("render", 0) == 0 || arguments.rfind("radii", 0) == 0)
            setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
        else
            unsetenv("ASAN_OPTIONS");
        Result result;
        FILE* pipe = popen(command.c_str(), "r");
        std::array<char, 4096> buffer;
        for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
            result.out.append(buffer.data(), n);
        result.code = WEXITSTATUS(pclose(pipe));
        std::ifstream file(err);
        result.err.assign(std::istreambuf_iterator<char>(file), {});
        return result;
    }
    std::string path(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
    TemporaryFolder folder_;
};

}  // namespace pcm::test
