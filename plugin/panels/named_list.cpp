#include "plugin/panels/named_list.h"

#include <QHeaderView>
#include <QSignalBlocker>

namespace pcm::host {

namespace {

constexpr int least_height = 90;     // pixels
constexpr int line_characters = 24;  // maximum for a value

void set_up(QTreeWidget& table, const char* object_name, const QStringList& columns)
{
    table.setObjectName(object_name);
    table.setHeaderLabels(columns);
    table.setRootIsDecorated(false);
    table.setAlternatingRowColors(true);
    table.header()->setMinimumSectionSize(20);
    for (int column = 0; column + 1 < columns.size(); ++column)
        table.header()->setSectionResizeMode(column, QHeaderView::ResizeToContents);
    table.header()->setStretchLastSection(true);
    table.setMinimumHeight(least_height);
}

// Three numbers one below the other, and sentences in lines: they are wider than a panel.
QString in_lines(const QString& value)
{
    const QStringList words = value.split(' ');
    bool numbers = words.size() == 3;
    for (const QString& word : words) {
        bool good = false;
        word.toDouble(&good);
        numbers = numbers && good;
    }
    if (numbers) return words.join('\n');
    QString lines = words.front();
    int length = lines.size();
    for (const QString& word : words.mid(1)) {
        const bool fits = length + 1 + word.size() <= line_characters;
        lines += (fits ? ' ' : '\n') + word;
        length = fits ? length + 1 + word.size() : word.size();
    }
    return lines;
}

}  // namespace

NamedList::NamedList(const char* object_name, const QStringList& columns)
{
    set_up(*this, object_name, columns);
    setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed);
    connect(this, &QTreeWidget::itemChanged, this, &NamedList::item_changed);
    connect(this, &QTreeWidget::itemSelectionChanged, this, [this] {
        const auto selected = selectedItems();
        emit chosen(selected.empty() ? -1 : indexOfTopLevelItem(selected.front()));
    });
}

void NamedList::show_rows(const std::vector<Row>& rows, std::optional<std::size_t> selected)
{
    const QSignalBlocker silent(this);
    clear();
    shown_.clear();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row& row = rows[i];
        auto* item = new QTreeWidgetItem(this);
        item->setText(0, QString::fromStdString(row.name));
        item->setIcon(0, row.icon);
        for (int k = 0; k < row.cells.size(); ++k) {
            item->setText(k + 1, row.cells[k]);
            item->setToolTip(k + 1, k < row.tooltips.size() ? row.tooltips[k] : row.cells[k]);
        }
        item->setCheckState(0, row.hidden ? Qt::Unchecked : Qt::Checked);
        item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable | Qt::ItemIsEditable);
        item->setSelected(selected == i);
        if (selected == i) setCurrentItem(item);
        shown_.emplace_back(row.name, row.hidden);
    }
}

void NamedList::item_changed(QTreeWidgetItem* item, int column)
{
    const int index = indexOfTopLevelItem(item);
    if (index < 0 || column != 0) return;
    const auto& [name, was_hidden] = shown_[static_cast<std::size_t>(index)];
    const bool is_hidden = item->checkState(0) == Qt::Unchecked;
    // The answer is show_rows(), in which this item does not survive.
    const QString text = item->text(0);
    if (is_hidden != was_hidden)
        QMetaObject::invokeMethod(
            this, [this, index, is_hidden] { emit hidden(index, is_hidden); }, Qt::QueuedConnection);
    else if (text != QString::fromStdString(name))
        QMetaObject::invokeMethod(
            this, [this, index, text] { emit renamed(index, text); }, Qt::QueuedConnection);
}

ValueTable::ValueTable(const char* object_name, const QString& heading) { set_up(*this, object_name, {"", heading}); }

void ValueTable::show_values(const std::vector<std::pair<QString, QString>>& values)
{
    clear();
    for (const auto& [name, value] : values) {
        auto* item = new QTreeWidgetItem(this, {name, in_lines(value)});
        item->setTextAlignment(0, Qt::AlignLeft | Qt::AlignTop);
        item->setToolTip(1, value);
    }
}

}  // namespace pcm::host
