#include "plugin/host/project_parts.h"

#include <utility>

namespace pcm::host {

namespace {

std::vector<ProjectPart>& parts()
{
    static auto* const parts = new std::vector<ProjectPart>;
    return *parts;
}

}  // namespace

void add_project_part(ProjectPart part) { parts().push_back(std::move(part)); }

const std::vector<ProjectPart>& project_parts() { return parts(); }

}  // namespace pcm::host
