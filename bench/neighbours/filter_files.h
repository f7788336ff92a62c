// What the other programs share in bench/neighbours/run.py. Each is started as
//
//     PROGRAM normals|outliers NEIGHBOURS THREADS SIGMAS SHARE POSITIONS RESULT
//
// reads doubles x y z, computes, writes floats (normals) or bytes (1: outlier) in the same order, and prints one line
// of JSON: the time of the computation alone, files apart.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcm::bench {

struct FilterRequest {
    std::string filter;
    int neighbours = 16, threads = 1;
    double sigmas = 2;  // outliers: a mean distance this many standard deviations above the mean of all
    double share = 0;   // outliers: or such a share of the points
};

struct FilterResult {
    std::vector<float> normals;
    std::vector<std::uint8_t> outliers;
};

inline int run_filter(int argc, char** argv,
                      const std::function<FilterResult(const FilterRequest&, const std::vector<double>&)>& run)
{
    try {
        if (argc != 8) throw std::runtime_error("seven arguments, see bench/neighbours/filter_files.h");
        const FilterRequest request{argv[1], std::stoi(argv[2]), std::stoi(argv[3]), std::stod(argv[4]),
                                    std::stod(argv[5])};
        std::ifstream in(argv[6], std::ios::binary | std::ios::ate);
        if (!in) throw std::runtime_error(std::string("cannot read ") + argv[6]);
        std::vector<double> xyz(static_cast<std::size_t>(in.tellg()) / sizeof(double));
        in.seekg(0);
        in.read(reinterpret_cast<char*>(xyz.data()), static_cast<std::streamsize>(xyz.size() * sizeof(double)));
        const auto start = std::chrono::steady_clock::now();
        const std::clock_t cpu_start = std::clock();
        const FilterResult result = run(request, xyz);
        const double cpu = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        std::ofstream out(argv[7], std::ios::binary);
        if (request.filter == "normals")
            out.write(reinterpret_cast<const char*>(result.normals.data()),
                      static_cast<std::streamsize>(result.normals.size() * sizeof(float)));
        else
            out.write(reinterpret_cast<const char*>(result.outliers.data()),
                      static_cast<std::streamsize>(result.outliers.size()));
        if (!out.flush()) throw std::runtime_error(std::string("cannot write ") + argv[7]);
        std::printf("{\"seconds\": %.6g, \"cpu_seconds\": %.6g}\n", seconds, cpu);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

}  // namespace pcm::bench
