#include "plugin/panels/clouds/move_fields.h"

#include "pcm/cloud/affine.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/scene_view.h"
#include "plugin/scene/text.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>

#include <stdexcept>

namespace pcm::host {

namespace {

double number_in(const QLineEdit& field, const char* what)
{
    bool good = false;
    const double value = field.text().trimmed().toDouble(&good);
    if (!good) throw std::runtime_error(std::string(what) + ": '" + field.text().toStdString() + "' is not a number");
    return value;
}

}  // namespace

MoveFields::MoveFields(QWidget* parent) : QWidget(parent)
{
    auto* rows = new QGridLayout(this);
    rows->setContentsMargins(0, 0, 0, 0);
    const auto field = [&](int row, int column, const char* object, const char* value, const char* tooltip) {
        auto* edit = new QLineEdit(value);
        edit->setObjectName(object);
        edit->setToolTip(tooltip);
        edit->setMinimumWidth(50);
        rows->addWidget(edit, row, column);
        return edit;
    };
    rows->addWidget(new QLabel("Shift"), 0, 0);
    const char* const names[] = {"PointCloudMoveX", "PointCloudMoveY", "PointCloudMoveZ"};
    const char* const tooltips[] = {"Along x, source units. Default 0.", "Along y, source units. Default 0.",
                                    "Along z, source units. Default 0."};
    for (int a = 0; a < 3; ++a) translate_[std::size_t(a)] = field(0, a + 1, names[a], "0", tooltips[a]);
    rows->addWidget(new QLabel("Rotate"), 1, 0);
    axis_ = new QComboBox;
    axis_->setObjectName("PointCloudMoveAxis");
    axis_->addItems({"about z", "about y", "about x"});
    axis_->setToolTip("The axis through the centre of the cloud as it is shown. Default z.");
    rows->addWidget(axis_, 1, 1);
    degrees_ = field(1, 2, "PointCloudMoveDegrees", "0",
                     "Degrees, counter-clockwise where the axis points to the viewer. Default 0.");
    rows->addWidget(new QLabel("Scale by"), 2, 0);
    scale_ = field(2, 1, "PointCloudMoveScale", "1", "Factor about the centre of the cloud, above 0. Default 1.");
    const auto button = [&](int row, int column, const char* text, const char* tooltip, auto&& pressed) {
        auto* made = new QPushButton(text);
        made->setToolTip(tooltip);
        rows->addWidget(made, row, column);
        connect(made, &QPushButton::clicked, this, pressed);
        return made;
    };
    move_ = button(2, 3, "Move Layer",
                   "Turns and scales the current layer about its centre, then shifts it, by its matrix. The tree on "
                   "disk is not changed; the filter Transform Point Cloud Tree writes a moved one.",
                   [this] { move(); });
    undo_ = button(3, 1, "Undo Move", "Gives the layer the matrix that it had before.",
                   [this] { guarded([](SceneLayer& layer) { layer.scene().part<LayerMatrices>().undo(layer); }); });
    redo_ = button(3, 2, "Redo Move", "Repeats what was undone.",
                   [this] { guarded([](SceneLayer& layer) { layer.scene().part<LayerMatrices>().redo(layer); }); });
    reset_ =
        button(3, 3, "Reset Matrix", "Puts the layer where its cloud is; Undo Move gives the matrix back.", [this] {
            guarded(
                [](SceneLayer& layer) { layer.scene().part<LayerMatrices>().set(layer, identity_matrix, "reset"); });
        });
    words_ = new QLabel;
    words_->setObjectName("PointCloudMoveMessage");
    words_->setWordWrap(true);
    rows->addWidget(words_, 4, 0, 1, 4);
}

void MoveFields::refresh(Scene* scene)
{
    scene_ = scene;
    const SceneLayer* layer = scene ? scene->current() : nullptr;
    const bool cloud = layer && layer->drawn();
    move_->setEnabled(cloud);
    reset_->setEnabled(cloud && layer->matrix() != identity_matrix);
    undo_->setEnabled(cloud && !scene->part<LayerMatrices>().undo_words(*layer).isEmpty());
    redo_->setEnabled(cloud && !scene->part<LayerMatrices>().redo_words(*layer).isEmpty());
}

void MoveFields::guarded(const std::function<void(SceneLayer&)>& work)
{
    SceneLayer* const layer = scene_ && !scene_->is_busy() ? scene_->current() : nullptr;
    if (!layer || !layer->drawn()) return;
    try {
        work(*layer);
        words_->setText(QString());
    } catch (...) {
        words_->setText(QString::fromStdString(current_error()));
    }
    refresh(scene_);
}

void MoveFields::move()
{
    guarded([this](SceneLayer& layer) {
        const LayerCloud tree = *layer.drawn();
        const Affine present = map_of(layer.matrix(), tree.origin);
        const Vec3d centre = present(tree.cloud->info().bounds().centre());
        const double scale = number_in(*scale_, "Scale");
        if (!(scale > 0)) throw std::runtime_error("Scale is not above 0");
        Vec3d axis{0, 0, 0};
        axis[std::size_t(2 - axis_->currentIndex())] = 1;
        const double radians = number_in(*degrees_, "Rotate") * pi / 180;
        Affine map = Affine::rotation(axis, radians, centre, scale);
        for (std::size_t a = 0; a < 3; ++a) map.target[a] += number_in(*translate_[a], "Shift");
        layer.scene().part<LayerMatrices>().set(layer, matrix_of(after(map, present), tree.origin), "move");
    });
}

}  // namespace pcm::host
