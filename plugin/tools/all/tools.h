// The tools, in the order in which the program lists them. A new tool is a folder and a row of the table in tools.cpp.
#pragma once

#include "plugin/tools/tool.h"

#include <QIcon>

#include <memory>
#include <vector>

namespace pcm::host {

struct ToolRow {
    const char* name;
    const char* description;
    QIcon (*icon)();
    std::unique_ptr<Tool> (*make)();  // one per view
};

const std::vector<ToolRow>& tools();

}  // namespace pcm::host
