#include "plugin/panels/clouds/layer_list.h"

#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/layer_visibility.h"
#include "plugin/scene/scene_view.h"
#include "plugin/scene/text.h"

#include <QHeaderView>
#include <QMainWindow>

#include <tuple>

namespace pcm::host {

bool LayerList::Row::operator==(const Row& other) const
{
    const auto all = [](const Row& r) {
        return std::tie(r.layer_id, r.label, r.points, r.current, r.visible, r.solo, r.locked);
    };
    return all(*this) == all(other);
}

LayerList::LayerList(QWidget* parent) : QTableWidget(0, columns, parent)
{
    setObjectName("PointCloudLayers");
    setHorizontalHeaderLabels({"Layer", "Points", "Visible", "Solo", "Lock"});
    const char* const tooltips[columns] = {
        "The layers that show point clouds. A click makes one MeshLab's current layer.",
        "Number of points of the whole cloud.", "Whether the views show the layer.",
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

std::vector<LayerList::Row> LayerList::rows_of(Scene& scene)
{
    std::vector<Row> rows;
    for (const SceneLayer* layer : scene.layers()) {
        const auto tree = layer->drawn();
        if (!tree) continue;
        rows.push_back({layer->id(), layer->label(), QString::fromStdString(grouped(tree->cloud->info().points)),
                        layer == scene.current(), layer->is_visible(), scene.part<SoloLayers>().is_solo(*layer),
                        scene.part<LayerMatrices>().is_locked(*layer)});
    }
    return rows;
}

void LayerList::refresh(Scene* scene)
{
    const bool other = scene != scene_;
    std::vector<Row> rows = scene && !scene->is_busy() ? rows_of(*scene) : scene ? rows_ : std::vector<Row>();
    scene_ = scene;
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

SceneLayer* LayerList::layer_in(int row) const
{
    if (!scene_ || row < 0 || row >= int(rows_.size())) return nullptr;
    return scene_->layer(rows_[std::size_t(row)].layer_id);
}

void LayerList::ticked(QTableWidgetItem* item)
{
    SceneLayer* const layer = layer_in(item->row());
    if (filling_ || !layer || scene_->is_busy()) return;
    const bool on = item->checkState() == Qt::Checked;
    if (item->column() == visible) layer->show(on);
    if (item->column() == solo) scene_->part<SoloLayers>().set(*layer, on);
    if (item->column() == locked) scene_->part<LayerMatrices>().lock(*layer, on);
    refresh(scene_);
    scene_->refresh_layer_lists();
}

void LayerList::chosen()
{
    const auto rows = selectionModel()->selectedRows();
    SceneLayer* const layer = rows.empty() ? nullptr : layer_in(rows.first().row());
    if (filling_ || !layer || scene_->is_busy() || layer == scene_->current()) return;
    scene_->make_current(layer->id());
    refresh(scene_);
    scene_->refresh_layer_lists();
}

}  // namespace pcm::host
