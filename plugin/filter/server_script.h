// Scripts of meshlabserver that lack parameters, because they were written before these existed.
//
// meshlabserver asks a filter for its parameters and asserts that the script has as many. So the filter must not name
// those that the script lacks: they keep their defaults (operation_parameters.h), and the log lists them.
#pragma once

#include "plugin/scene/parameters.h"

namespace pcm::host {

// The process is meshlabserver: its scripts may name parameters that dialogs do not show.
bool is_server();

// Leaves out the parameters that the script does not have, where the process runs one (meshlabserver -s SCRIPT) with
// the filter `name`. Called once for each time that the filter runs; calls are counted, as a script may run a filter
// several times. Does nothing in a window, and where the script cannot be read.
void keep_those_of_script(const QString& name, Parameters& parameters);

}  // namespace pcm::host
