// The commands of a script. A command is one function and one row of the table of its file.
#pragma once

#include "tests/e2e/driver/driver.h"

#include <vector>

struct Command {
    const char* name;
    Done (*run)(TestDriver& driver, const QString& argument);
};

std::vector<Command> waiting_commands();  // until something is shown, drawn or logged
std::vector<Command> window_commands();   // menus, dialogs, files
std::vector<Command> view_commands();     // mouse and keys in the view, layers
std::vector<Command> tool_commands();     // the tools of point clouds
std::vector<Command> place_commands();    // places of the scene in the view
std::vector<Command> table_commands();    // tables of panels
std::vector<Command> panel_commands();    // the panels of tools
std::vector<Command> output_commands();   // pictures, and state as text
