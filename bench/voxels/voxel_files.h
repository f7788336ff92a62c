// What the programs of bench/voxels/run.py share. Each is started as
//
//     PROGRAM SIZE THREADS POSITIONS RESULT
//
// reads doubles x y z (ours also a tree), makes a voxel grid of cubes of this size, writes the centroids as doubles,
// and prints one line of JSON: the time of the computation alone, files of positions apart, and the peak memory.
#pragma once

#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcm::bench {

inline std::vector<double> read_doubles(const std::string& path)
{
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    if (!in) throw std::runtime_error("cannot read " + path);
    std::vector<double> xyz(static_cast<std::size_t>(in.tellg()) / sizeof(double));
    in.seekg(0);
    in.read(reinterpret_cast<char*>(xyz.data()), static_cast<std::streamsize>(xyz.size() * sizeof(double)));
    return xyz;
}

inline void write_doubles(const std::string& path, const std::vector<double>& xyz)
{
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(xyz.data()), static_cast<std::streamsize>(xyz.size() * sizeof(double)));
    if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

class Stopwatch {
public:
    void print() const
    {
        // Peak of this program alone: getrusage() counts the one that started it too.
        double peak = 0;
        std::ifstream status("/proc/self/status");
        for (std::string word; status >> word;)
            if (word == "VmHWM:") status >> peak;
        std::printf("{\"seconds\": %.6g, \"cpu_seconds\": %.6g, \"peak_mb\": %.1f}\n",
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(),
                    static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC, peak / 1024);
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::clock_t cpu_ = std::clock();
};

// `run` prepares, starts a Stopwatch, computes, prints it, and writes the result.
template <class Run>
int run_voxels(int argc, char** argv, const Run& run)
{
    try {
        if (argc != 5) throw std::runtime_error("four arguments, see bench/voxels/voxel_files.h");
        run(std::stod(argv[1]), static_cast<unsigned>(std::stoul(argv[2])), argv[3], argv[4]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

}  // namespace pcm::bench
