#include "plugin/render/clouds/layer_list.h"

#include "plugin/host/layer_matrix.h"
#include "plugin/host/layer_visibility.h"
#include "plugin/host/registry.h"
#include "plugin/host/text.h"

#include <meshlab/glarea.h>

#include <QHeaderView>
#include <QMainWindow>

#include <tuple>

namespace pcm::host {

namespace {

void update_window(const MeshDocument& document)
{
    for (GLArea* view : views_of(document))
        if (QMainWindow* window = window_of(*view)) {
            QMetaObject::invokeMethod(window, "updateLayerDialog");
            return;
        }
}

}  // namespace

bool LayerList::Row::operator==(const Row& other) const
{
    const auto all = [](const Row& r) {
        return std::tie(r.mesh_id, r.label, r.points, r.current, r.visible, r.solo, r.locked);
    };
    return all(*this) == all(other);
}

LayerList::LayerList(QWidget* parent) : QTableWidget(0, columns, parent)
{
    setObjectName("PointCloudLayers");
    setHorizontalHeaderLabels({"Layer", "Points", "Visible", "Solo", "Lock"});
    const char* const tooltips[columns] = {
        "The layers that show point clouds. A click makes one MeshLab's current layer.", "Of the whole cloud.",
        "Whether the views show the layer.",
        "Shows only the layers that are ticked here; when none is ticked any more, all are as they were. Default off.",
        "A locked layer cannot be moved, and its points cannot be changed in place. Default off."};
    for (int c = 0; c < columns; ++c) horizontalHeaderItem(c)->setToolTip(tooltips[c]);
    verticalHeader()->hide();
    setSelectionBehavior(QAbstractItemView::SelectRows);
    setSelectionMode(QAbstractItemView::SingleSelection);
    setEditTriggers(QAbstractItemView::NoEditTriggers);
    horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    horizontalHeader()->setSectionResizeMode(name, QHeaderView::Stretch);
    connect(this, &QTableWidget::itemChanged, this, &LayerList::ticked);
    connect(this, &QTableWidget::itemSelectionChanged, this, &LayerList::chosen);
}

std::vector<LayerList::Row> LayerList::rows_of(MeshDocument& document)
{
    std::vector<Row> rows;
    for (const MeshModel* layer : document.meshList) {
        if (!layer) continue;
        const auto tree = Registry::instance().drawn(*layer);
        if (!tree) continue;
        rows.push_back({layer->id(), layer->label(), QString::fromStdString(grouped(tree->cloud->info().points)),
                        layer == document.mm(), layer->visible, SoloLayers::of(document).is_solo(*layer),
                        LayerMatrices::of(document).is_locked(*layer)});
    }
    return rows;
}

void LayerList::refresh(MeshDocument* document)
{
    const bool other = document != document_;
    std::vector<Row> rows = document && !document->isBusy() ? rows_of(*document)
                            : document                      ? rows_
                                                            : std::vector<Row>();
    document_ = document;
    if (!other && rows == rows_) return;
    rows_ = std::move(rows);
    fill();
}

void LayerList::fill()
{
    filling_ = true;
    setRowCount(int(rows_.size()));
    for (int r = 0; r < int(rows_.size()); ++r) {
        const Row& row = rows_[std::size_t(r)];
        auto* label = new QTableWidgetItem(row.label);
        QFont font = label->font();
        font.setBold(row.current);
        label->setFont(font);
        setItem(r, name, label);
        auto* count = new QTableWidgetItem(row.points);
        count->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
        setItem(r, points, count);
        const bool states[] = {row.visible, row.solo, row.locked};
        for (int c = visible; c < columns; ++c) {
            auto* tick = new QTableWidgetItem;
            tick->setFlags(Qt::ItemIsUserCheckable | Qt::ItemIsEnabled);
            tick->setCheckState(states[c - visible] ? Qt::Checked : Qt::Unchecked);
            tick->setToolTip(horizontalHeaderItem(c)->toolTip());
            setItem(r, c, tick);
        }
        if (row.current) selectRow(r);
    }
    filling_ = false;
}

MeshModel* LayerList::layer_in(int row) const
{
    if (!document_ || row < 0 || row >= int(rows_.size())) return nullptr;
    return document_->getMesh(rows_[std::size_t(row)].mesh_id);
}

void LayerList::ticked(QTableWidgetItem* item)
{
    MeshModel* const layer = layer_in(item->row());
    if (filling_ || !layer || document_->isBusy()) return;
    const bool on = item->checkState() == Qt::Checked;
    if (item->column() == visible) show_layer(*layer, on);
    if (item->column() == solo) SoloLayers::of(*document_).set(*layer, on);
    if (item->column() == locked) LayerMatrices::of(*document_).lock(*layer, on);
    refresh(document_);
    update_window(*document_);
}

void LayerList::chosen()
{
    const auto rows = selectionModel()->selectedRows();
    MeshModel* const layer = rows.empty() ? nullptr : layer_in(rows.first().row());
    if (filling_ || !layer || document_->isBusy() || layer == document_->mm()) return;
    document_->setCurrentMesh(layer->id());
    refresh(document_);
    update_window(*document_);
}

}  // namespace pcm::host
