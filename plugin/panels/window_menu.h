// The menus of the main window.
#pragma once

#include <QMainWindow>

class QAction;

namespace pcm::host {

// Appends an action to the menu of this title, without its ampersand; nothing where there is no such menu.
void add_to_menu(QMainWindow& window, const QString& title, QAction* action, bool after_separator = false);

// *Help > Point Clouds*, which opens the manual; once for a window.
void add_manual_to_help(QMainWindow& window);

}  // namespace pcm::host
