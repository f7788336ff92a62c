// Scenes on which verdicts of fits are right or wrong, for sweeps of tuned numbers.
#pragma once

#include "bench/fit/fit_scene.h"
#include "pcm/fit/shape_fit.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm::bench {

// A scene, what is asked of it, and what is as right as it can be.
struct VerdictScene {
    FitScene scene;
    ShapeFitOptions asked;
    double oracle = 0;  // surface error of the oracle, m
};

// For each seed from `first` on: all kinds of shapes among 30, 60 and 80 % outliers, of 100 to 1000 points, and short
// arcs, with automatic thresholds; arcs with a given one, too; another kind than that of the points is asked for; and
// all but 3 % of the points are outliers.
std::vector<VerdictScene> verdict_scenes(std::uint64_t first, std::uint64_t seeds);

// Numbers of answers. Right: the surface error is at most three times the oracle's, or 1.7 mm where that is more.
struct Verdicts {
    int right_good = 0, right_doubtful = 0, wrong_good = 0, wrong_doubtful = 0;
    double error = 0;  // surface error of the right ones relative to the oracle's, median
};
Verdicts judge(const std::vector<VerdictScene>& scenes);

std::vector<std::string> heads_of_verdicts();
std::vector<std::string> cells_of(const Verdicts& verdicts);

}  // namespace pcm::bench
