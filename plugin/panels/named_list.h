// The table of things with names in the panels of tools: a tick shows one in views, a double click on a name changes
// it. GUI thread.
#pragma once

#include <QIcon>
#include <QString>
#include <QStringList>
#include <QTreeWidget>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcm::host {

class NamedList : public QTreeWidget {
    Q_OBJECT

public:
    struct Row {
        std::string name;
        bool hidden = false;
        QStringList cells;  // texts of the other columns
        QIcon icon{};
        QStringList tooltips{};  // tooltips of the cells; the cells' texts where there are none
    };

    // The first column has the names.
    NamedList(const char* object_name, const QStringList& columns);

    void show_rows(const std::vector<Row>& rows, std::optional<std::size_t> selected);

signals:
    // The user has renamed a row. What was typed is shown until show_rows().
    void renamed(int index, const QString& name);
    void hidden(int index, bool hidden);
    void chosen(int index);  // -1: none

private:
    void item_changed(QTreeWidgetItem* item, int column);

    std::vector<std::pair<std::string, bool>> shown_;  // names and whether hidden, as last shown
};

// Names and values of one thing, in two columns. Coordinates take three lines; sentences are broken into lines.
class ValueTable : public QTreeWidget {
public:
    ValueTable(const char* object_name, const QString& heading);

    void show_values(const std::vector<std::pair<QString, QString>>& values);
};

}  // namespace pcm::host
