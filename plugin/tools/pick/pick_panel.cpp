#include "plugin/tools/pick/pick_panel.h"

#include "plugin/panels/message_area.h"
#include "plugin/panels/tool_dock.h"

#include <QHeaderView>
#include <QPushButton>
#include <QShortcut>
#include <QTableWidget>
#include <QVBoxLayout>

namespace pcm::host {

namespace {

constexpr int message_lines = 4;

}  // namespace

PickPanel::PickPanel(QWidget* window) : QDockWidget("Picked Point", window)
{
    setObjectName("PickPointDock");
    auto* content = new QWidget(this);
    auto* layout = new QVBoxLayout(content);
    message_ = new MessageArea("PickPointMessage", message_lines);
    message_->say("Click a point in the view.");
    table_ = new QTableWidget(0, 2, content);
    table_->setObjectName("PickPointTable");
    table_->setHorizontalHeaderLabels({"Name", "Value"});
    table_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
    table_->horizontalHeader()->setStretchLastSection(true);
    table_->verticalHeader()->hide();
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setToolTip(
        "The picked point: source coordinates with every digit of the file, every attribute in its own "
        "unit; spacing and grid step in source units");
    copy_ = new QPushButton("Copy", content);
    copy_->setToolTip("Copies names and values as text, separated by tabs (Ctrl+C)");
    copy_->setEnabled(false);
    layout->addWidget(message_);
    layout->addWidget(table_);
    layout->addWidget(copy_);
    fill_dock(*this, content);
    connect(copy_, &QPushButton::clicked, this, &PickPanel::copy_asked);
    auto* shortcut = new QShortcut(QKeySequence::Copy, this);
    shortcut->setContext(Qt::WidgetWithChildrenShortcut);
    connect(shortcut, &QShortcut::activated, this, &PickPanel::copy_asked);
}

void PickPanel::show_point(const std::vector<PickedLine>& lines, bool complete)
{
    table_->setRowCount(static_cast<int>(lines.size()));
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const int row = static_cast<int>(i);
        table_->setItem(row, 0, new QTableWidgetItem(lines[i].name));
        auto* value = new QTableWidgetItem(lines[i].value);
        value->setToolTip(lines[i].value);  // where the column is too narrow
        table_->setItem(row, 1, value);
    }
    table_->setEnabled(complete);
    copy_->setEnabled(complete);
}

void PickPanel::say(const QString& text) { message_->say(text); }

}  // namespace pcm::host
