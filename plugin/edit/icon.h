#pragma once

#include <QIcon>

namespace pcm::host {

// An eye above the arrows that move it.
QIcon first_person_icon();

}  // namespace pcm::host
