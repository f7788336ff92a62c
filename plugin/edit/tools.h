// The tools that MeshLab lists under Edit. A new tool is a folder and a row of the table in tools.cpp.
#pragma once

#include <common/interfaces.h>

#include <QIcon>

#include <vector>

namespace pcm::host {

struct Tool {
    const char* name;
    const char* description;
    QIcon (*icon)();
    MeshEditInterface* (*make)();  // one per view
};

const std::vector<Tool>& tools();

}  // namespace pcm::host
