// Icons of the tools, painted at run time.
#pragma once

#include <QIcon>

namespace pcm::host {

// An eye above four arrows.
QIcon first_person_icon();

}  // namespace pcm::host
