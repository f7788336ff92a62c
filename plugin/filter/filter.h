// One filter of the program's menu.
//
// A filter is a row of the table of operations (operation_filter.h), or one file which defines a function that returns
// it; filters.cpp lists them all. The program's plugin shows them (meshlab/filter).
#pragma once

#include "pcm/ops/result.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/parameters.h"
#include "plugin/scene/scene.h"

#include <functional>
#include <string>
#include <vector>

namespace pcm::host {

// What a filter works on and reports to. GUI thread.
struct FilterRun {
    Scene& scene;
    const Parameters& parameters;
    ProgressCallback* callback;                        // for panels/operation.h
    std::function<void(const std::string& line)> log;  // writes a line to the program's log
    // The same for what went wrong after the filter had done its work.
    std::function<void(const std::string& line)> warn;
    std::function<void(const ops::Json& answer)> answer = {};  // takes what the operation has found; empty: nobody asks
};

// The menus that list a filter: bits of ops::menu, and this one.
inline constexpr unsigned camera_menu = 1u << 16;

struct Filter {
    const char* name;  // in the menu and in scripts
    QString info;      // the help text, HTML
    unsigned menus;
    std::function<void(Parameters& parameters)> add_parameters;
    // Anything thrown is reported to the user as the reason why the filter failed.
    std::function<void(const FilterRun& run)> run;
    // The end of the name that dialogs propose for the result, as in NAME-normals.pct (proposed_output.h); null: none
    // is needed. Scripts name their outputs.
    const char* output = nullptr;
};

// The table, in the order of the menu.
const std::vector<Filter>& filters();

}  // namespace pcm::host
