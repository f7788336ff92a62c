// Tables of panels as text: both lists and trees, by the names of their objects.
#include "tests/e2e/driver/commands.h"

#include <QAbstractItemView>
#include <QApplication>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

namespace {

QAbstractItemView* table_of(const QString& name)
{
    for (QWidget* widget : qApp->allWidgets())
        if (widget->objectName() == name)
            if (auto* table = qobject_cast<QAbstractItemView*>(widget)) return table;
    return nullptr;
}

// print-table NAME: its rows as JSON. A cell that only has a box to tick is true or false; of a cell with a text and a
// box, the box stands at the end of the row.
Done print_table(TestDriver& driver, const QString& name)
{
    const auto* table = table_of(name);
    if (!table) driver.fail("no table '" + name + "'");
    const QAbstractItemModel& model = *table->model();
    QJsonArray rows;
    for (int r = 0; r < model.rowCount(); ++r) {
        QJsonArray row, ticks;
        for (int c = 0; c < model.columnCount(); ++c) {
            const QModelIndex cell = model.index(r, c);
            const QString text = cell.data().toString();
            const QVariant tick = cell.data(Qt::CheckStateRole);
            const bool ticked = tick.toInt() == Qt::Checked;
            if (tick.isValid() && text.isEmpty()) {
                row << ticked;
                continue;
            }
            row << (cell.data().isValid() ? QJsonValue(text) : QJsonValue());
            if (tick.isValid()) ticks << ticked;
        }
        for (const auto& tick : ticks) row << tick;
        rows << row;
    }
    say("table " + QJsonDocument(QJsonObject{{"name", name}, {"rows", rows}}).toJson(QJsonDocument::Compact));
    return Done::yes;
}

// wait-rows NAME COUNT TEXT: until the table has this number of rows, and the text is in its last one
Done wait_rows(TestDriver& driver, const QString& argument)
{
    const auto* table = table_of(argument.section(' ', 0, 0));
    const int rows = argument.section(' ', 1, 1).toInt();
    const QString text = argument.section(' ', 2);
    bool found = table && table->model()->rowCount() == rows;
    if (found && rows > 0 && !text.isEmpty()) {
        QStringList cells;
        for (int c = 0; c < table->model()->columnCount(); ++c)
            cells << table->model()->index(rows - 1, c).data().toString();
        found = cells.join(" | ").contains(text);
    }
    return driver.until(found, "the table '" + argument + "'" +
                                   (table ? ", now of " + QString::number(table->model()->rowCount()) + " rows" : ""));
}

}  // namespace

std::vector<Command> table_commands() { return {{"print-table", print_table}, {"wait-rows", wait_rows}}; }
