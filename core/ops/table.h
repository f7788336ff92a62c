// For the sources of operations: how rows are made.
#pragma once

#include "pcm/ops/operation.h"

#include <memory>

namespace pcm::ops {

template <class T>
std::unique_ptr<Operation> make()
{
    return std::make_unique<T>();
}

}  // namespace pcm::ops
