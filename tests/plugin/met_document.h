// A document that is found by its layers, as those of MeshLab's window are in all generations.
#pragma once

#include "plugin/meshlab/meshlab.h"

namespace pcm::host {

struct MetDocument : MeshDocument {
    MetDocument() { meet(*this); }
};

}  // namespace pcm::host
