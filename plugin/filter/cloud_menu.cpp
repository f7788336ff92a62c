#include "plugin/filter/cloud_menu.h"

#include <QAction>
#include <QApplication>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QTimer>

#include <vector>

namespace pcm::host {

namespace {

const char* const object_name = "PointCloudMenu";
constexpr int look_ms = 200;  // for the window, which MeshLab makes after the plugins

// A row of the menu: what it is called there, and the text of MeshLab's action that it starts. Scripts know filters by
// that text. Without a row's own text the action itself is listed: a tool, which shows whether it is on.
struct Row {
    const char* text;
    const char* action;
};
struct Group {
    const char* title;
    std::vector<Row> rows;
};

const std::vector<Group>& groups()
{
    static const std::vector<Group> table{
        {"Open and Build",
         {{"Open a Cloud...", "Import Mesh..."},
          {"Open a Cloud on a Server...", "Open Point Cloud Tree by Address"},
          {"Build a Cloud of Files...", "Build Point Cloud Tree"},
          {"Append Files to a Cloud...", "Append to Point Cloud Tree"},
          {"Merge Clouds...", "Merge Point Cloud Trees"}}},
        {"Look",
         {{nullptr, "First Person Navigation"},
          {nullptr, "Pick Point"},
          {nullptr, "Clip Box"},
          {"Clip Box by Numbers...", "Set Clip Box"},
          {"About the Cloud...", "Point Cloud Tree Information"}}},
        {"Select",
         {{nullptr, "Select Points"},
          {"Select by Region or Conditions...", "Select Points of Point Cloud Tree"},
          {"Extract Selected Points...", "Selected Points: Extract"},
          {"Delete Selected Points...", "Selected Points: Delete"},
          {"Classify Selected Points...", "Selected Points: Classify"},
          {"Save the Selection as an Attribute...", "Selected Points: Save as Attribute"}}},
        {"Clean and Thin",
         {{"Remove Outliers...", "Remove Outliers of Point Cloud Tree"},
          {"Delete Points by Box or Conditions...", "Delete Points of Point Cloud Tree"},
          {"Subsample...", "Subsample Point Cloud Tree"},
          {"Voxel Grid...", "Voxel Grid of Point Cloud Tree"},
          {"Estimate Normals...", "Estimate Normals of Point Cloud Tree"},
          {"Estimate Radii...", "Estimate Radii of Point Cloud Tree"},
          {"Compact After Changes...", "Compact Point Cloud Tree"}}},
        {"Move and Align",
         {{nullptr, "Align by Picked Pairs"},
          {"Align by Typed Pairs...", "Align Point Clouds by Pairs"},
          {"Transform...", "Transform Point Cloud Tree"}}},
        {"Measure",
         {{nullptr, "Measure"},
          {"Measure Typed Points...", "Measure"},
          {"Cross-Section Profile...", "Cross-Section Profile"},
          {"Cut Volume...", "Cut Volume"}}},
        {"Fit",
         {{nullptr, "Fit Primitives"},
          {"Fit at Typed Places...", "Fit Primitive"},
          {"Detect All Primitives...", "Detect Primitives"}}},
        {"Export", {{"Export the Cloud...", "Export Mesh As..."}, {"Export Primitives...", "Export Primitives"}}},
    };
    return table;
}

// A tool can be on; a filter of the same text cannot.
QAction* action_of(const QMainWindow& window, const QString& text, bool is_tool)
{
    QList<QAction*> actions = window.findChildren<QAction*>(QString(), Qt::FindDirectChildrenOnly);
    for (const QMenu* menu : window.findChildren<QMenu*>())
        if (menu->objectName() != object_name) actions += menu->actions();
    for (QAction* action : actions)
        if (action->text().remove('&') == text && action->isCheckable() == is_tool && !action->menu()) return action;
    return nullptr;
}

// An entry of another text for an action.
QAction* entry_for(QAction& action, const QString& text, QObject& menu)
{
    auto* entry = new QAction(text, &menu);
    entry->setToolTip(action.toolTip());
    QObject::connect(entry, &QAction::triggered, &action, &QAction::trigger);
    return entry;
}

QMenu* new_menu(QMainWindow& window)
{
    auto* menu = new QMenu("Point Clouds", &window);
    menu->setObjectName(object_name);
    for (const Group& group : groups()) {
        auto* part = new QMenu(group.title, menu);
        part->setObjectName(object_name);
        for (const Row& row : group.rows)
            if (QAction* action = action_of(window, row.action, row.text == nullptr))
                part->addAction(row.text ? entry_for(*action, row.text, *part) : action);
        if (!part->isEmpty()) menu->addMenu(part);
    }
    return menu;
}

void put_first(QMainWindow& window, QMenu& filters)
{
    for (const QAction* action : filters.actions())
        if (action->menu() && action->menu()->objectName() == object_name) return;
    for (QAction* action : filters.actions())
        if (action->menu()) {
            filters.insertMenu(action, new_menu(window));
            filters.insertSeparator(action);
            return;
        }
}

bool add_to_window()
{
    for (QWidget* widget : QApplication::topLevelWidgets()) {
        auto* window = widget->inherits("MainWindow") ? qobject_cast<QMainWindow*>(widget) : nullptr;
        if (!window) continue;
        for (const QAction* action : window->menuBar()->actions()) {
            QMenu* const filters = action->menu();
            if (!filters || action->text().remove('&') != "Filters") continue;
            // MeshLab makes the menu anew when plugins are switched on or off.
            QObject::connect(filters, &QMenu::aboutToShow, window, [window, filters] { put_first(*window, *filters); });
            put_first(*window, *filters);
            return true;
        }
    }
    return false;
}

void add_when_ready(int tries)
{
    QTimer::singleShot(look_ms, qApp, [tries] {
        if (!add_to_window() && tries > 1) add_when_ready(tries - 1);
    });
}

}  // namespace

void add_cloud_menu()
{
    constexpr int most_tries = 100;
    if (qApp) add_when_ready(most_tries);
}

}  // namespace pcm::host
