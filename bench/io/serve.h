// What the programs of the reading benchmark share: they do as the lines on their standard input say, so that
// bench/io/run.py can let several take turns in one run.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcm::bench {

struct Answer {
    double seconds = 0;
    double cpu_seconds = 0;  // CPU time of all threads
    std::uint64_t points = 0;
    std::uint64_t values = 0;  // scalars kept of a point, coordinates included
    double error = 0;          // largest distance on an axis, of a comparison
};

// Calls `work` with the fields of each line (separated by tabs), and prints what it answers as a line of JSON.
inline int serve(const std::function<Answer(const std::vector<std::string>&)>& work)
{
    for (std::string line; std::getline(std::cin, line);) {
        std::vector<std::string> fields(1);
        for (const char c : line) {
            if (c == '\t')
                fields.emplace_back();
            else
                fields.back() += c;
        }
        try {
            const Answer a = work(fields);
            std::printf(
                "{\"seconds\": %.9g, \"cpu_seconds\": %.9g, \"points\": %llu, \"values\": %llu, \"error\": %.9g}\n",
                a.seconds, a.cpu_seconds, static_cast<unsigned long long>(a.points),
                static_cast<unsigned long long>(a.values), a.error);
        } catch (const std::exception& error) {
            std::string text;
            for (const char c : std::string(error.what())) {
                if (c == '"' || c == '\\') text += '\\';
                text += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
            }
            std::printf("{\"failed\": \"%s\"}\n", text.c_str());
        }
        std::fflush(stdout);
    }
    return 0;
}

class Stopwatch {
public:
    void stop(Answer& answer) const
    {
        answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        answer.cpu_seconds = static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC;
    }

private:
    std::clock_t cpu_start_ = std::clock();
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Writes doubles x y z of consecutive points, for the comparison of positions.
class PositionsFile {
public:
    explicit PositionsFile(const std::string& path) : file_(std::fopen(path.c_str(), "wb"))
    {
        if (!file_) throw std::runtime_error("cannot write " + path);
    }
    ~PositionsFile() { std::fclose(file_); }
    PositionsFile(const PositionsFile&) = delete;
    PositionsFile& operator=(const PositionsFile&) = delete;
    void add(double x, double y, double z)
    {
        const double p[3] = {x, y, z};
        if (std::fwrite(p, sizeof p, 1, file_) != 1) throw std::runtime_error("cannot write the positions");
    }

private:
    std::FILE* file_;
};

}  // namespace pcm::bench
