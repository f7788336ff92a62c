// One filter of MeshLab's menu Filters.
//
// A filter is one file, which defines a function that returns it, and one row of the table in filters.cpp.
#pragma once

#include <common/interfaces.h>

#include <functional>
#include <string>
#include <vector>

namespace pcm::host {

// What a filter works on and reports to. GUI thread.
struct FilterRun {
    MeshDocument& document;
    const RichParameterList& parameters;
    vcg::CallBackPos* callback;                        // for panels/operation.h
    std::function<void(const std::string& line)> log;  // writes a line to MeshLab's log
    // The same for what went wrong after the filter had done its work.
    std::function<void(const std::string& line)> warn;
};

struct Filter {
    const char* name;  // in the menu and in scripts
    QString info;      // the help text, HTML
    // The menus that list it. After a filter the view is reset where the layers have outgrown what it showed.
    MeshFilterInterface::FilterClass menus;
    std::function<void(RichParameterList& parameters)> add_parameters;
    // Anything thrown is reported to the user as the reason why the filter failed.
    std::function<void(const FilterRun& run)> run;
    // The end of the name that dialogs propose for the result, as in NAME-normals.pct (meshlab/2020/proposed_output.h);
    // null: none is needed. Scripts name their outputs.
    const char* output = nullptr;
};

// The table, in the order of the menu.
const std::vector<Filter>& filters();

}  // namespace pcm::host
