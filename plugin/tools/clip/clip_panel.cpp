#include "plugin/tools/clip/clip_panel.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/text.h"
#include "plugin/panels/message_area.h"
#include "plugin/panels/tool_dock.h"
#include "plugin/scene/tidy_numbers.h"
#include "plugin/tools/clip/box_handles.h"

#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr int most_steps = 100000;  // maximum number of steps of the slider
constexpr int message_lines = 4;

// The range of the bounds' corners along an axis of the box.
std::array<double, 2> range_along(const Box3d& bounds, const Vec3d& axis)
{
    std::array<double, 2> range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Vec3d& corner : corners_of(box_around(bounds))) {
        range[0] = std::min(range[0], dot(corner, axis));
        range[1] = std::max(range[1], dot(corner, axis));
    }
    return range;
}

QString degrees_text(double degrees) { return QString::number(degrees, 'g', 12); }

}  // namespace

ClipPanel::ClipPanel(QWidget* window) : QDockWidget("Clip Box", window)
{
    setObjectName("PointCloudClipBoxDock");
    auto* form = new QWidget;
    auto* rows = new QGridLayout(form);
    enabled_ = new QCheckBox("Clip box on");
    enabled_->setToolTip("Whether the box hides points. The clouds are not changed. Default on. Key: Space.");
    side_ = new QComboBox;
    side_->addItems({"Inside", "Outside"});
    side_->setToolTip("Which points are shown: those in the box, or all others. Default Inside.");
    rows->addWidget(enabled_, 0, 0);
    auto* label = new QLabel("Points shown");
    label->setToolTip(side_->toolTip());
    rows->addWidget(label, 1, 0);
    rows->addWidget(side_, 1, 1, 1, 2);
    connect(enabled_, &QCheckBox::toggled, this, &ClipPanel::choose);
    connect(side_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &ClipPanel::choose);
    add_box_fields(*rows);
    add_slab_fields(*rows);
    words_ = new MessageArea("PointCloudClipBoxMessage", message_lines);
    const int end = rows->rowCount();
    add_button(*rows, end, 0, Button::undo, "Undo box", "Takes the last change of the box back. Ctrl+Z in the view.");
    add_button(*rows, end, 1, Button::redo, "Redo box", "Repeats what was undone. Ctrl+Shift+Z in the view.");
    add_button(*rows, end, 2, Button::remove, "Remove box", "Removes the box; Undo brings it back.");
    add_button(
        *rows, end + 1, 0, Button::keep_layer, "Keep the box's points",
        "Makes a new tree of the points of the current layer that the box shows, at full resolution and with all "
        "attributes, and shows it in a layer. The cloud itself is not changed. Hidden classes and conditions hold "
        "too.",
        2);
    add_button(*rows, end + 1, 2, Button::keep_file, "Points to a file",
               "Writes the same points to a file; the extension chooses the format.");
    rows->addWidget(words_, end + 2, 0, 1, 3);
    rows->setRowStretch(end + 3, 1);
    fill_dock(*this, form);
}

void ClipPanel::add_button(QGridLayout& rows, int row, int column, Button button, const char* text, const char* tooltip,
                           int span)
{
    auto* widget = buttons_[button] = new QPushButton(text);
    widget->setToolTip(tooltip);
    connect(widget, &QPushButton::clicked, this, [this, button] { emit pressed(button); });
    rows.addWidget(widget, row, column, 1, span);
}

QLineEdit* ClipPanel::add_field(QGridLayout& rows, Field field, const char* label, const char* tooltip)
{
    auto* edit = fields_[field] = new QLineEdit;
    auto* words = new QLabel(label);
    edit->setToolTip(tooltip);
    words->setToolTip(tooltip);
    const int row = rows.rowCount();
    rows.addWidget(words, row, 0);
    rows.addWidget(edit, row, 1, 1, 2);
    connect(edit, &QLineEdit::editingFinished, this, [this, field] { take(field); });
    return edit;
}

void ClipPanel::add_box_fields(QGridLayout& rows)
{
    const char* const centre = "The centre of the box, in source coordinates and units. Default: that of what is seen.";
    const char* const size =
        "The size of the box along its own axis, from face to face, in source units. Default: that of what is seen.";
    add_field(rows, centre_x, "Centre x", centre);
    add_field(rows, centre_y, "Centre y", centre);
    add_field(rows, centre_z, "Centre z", centre);
    add_field(rows, size_x, "Size x", size);
    add_field(rows, size_y, "Size y", size);
    add_field(rows, size_z, "Size z", size);
    add_field(
        rows, turn, "Turn",
        "The box is turned about the vertical by this many degrees, counter-clockwise seen from above. Default 0. "
        "Keys: R, Shift+R.");
    const int row = rows.rowCount();
    add_button(rows, row, 0, Button::from_view, "From view", "A box around what the view shows of the clouds.");
    add_button(rows, row, 1, Button::from_layer, "From layer", "A box around the current layer.");
    add_button(rows, row, 2, Button::box_from_points, "Two points",
               "A box between two points that you click: they are opposite corners in plan; as high as the clouds.");
}

void ClipPanel::add_slab_fields(QGridLayout& rows)
{
    axis_ = new QComboBox;
    axis_->setObjectName("PointCloudClipBoxAxis");
    axis_->addItems({"x", "y", "z"});
    axis_->setCurrentIndex(2);
    axis_->setToolTip("The axis of the box along which a slab is thin, and along which it is moved. Default z.");
    auto* label = new QLabel("Slab axis");
    label->setToolTip(axis_->toolTip());
    const int row = rows.rowCount();
    rows.addWidget(label, row, 0);
    rows.addWidget(axis_, row, 1, 1, 2);
    connect(axis_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] { show_slab(bounds_); });
    add_field(rows, thickness_field, "Thickness",
              "The thickness of the slab or section, in source units: the size of the box along the slab's axis. It is "
              "also the step by which the slab is moved. Default: the size of the box.");
    add_button(rows, row + 2, 0, Button::make_slab, "Slab",
               "Makes a slab of the box: as thin as 'Thickness' along the slab's axis, beyond the clouds along the "
               "others.");
    add_button(rows, row + 2, 1, Button::section_from_points, "Section",
               "A vertical section along the line between two points that you click, as wide as 'Thickness' (a "
               "fiftieth of the line where none is typed).");
    slider_ = new QSlider(Qt::Horizontal);
    slider_->setObjectName("PointCloudClipBoxSlider");
    slider_->setToolTip("Moves the slab through the clouds, in steps of its thickness. Keys: arrows.");
    add_button(rows, row + 3, 0, Button::step_back, "Step back", "Moves the slab by its thickness. Key: Left or Down.");
    rows.addWidget(slider_, row + 3, 1);
    add_button(rows, row + 3, 2, Button::step_ahead, "Step ahead",
               "Moves the slab by its thickness. Key: Right or Up; with Shift by a tenth of it.");
    connect(slider_, &QSlider::valueChanged, this, &ClipPanel::slide);
}

std::size_t ClipPanel::slab_axis() const { return static_cast<std::size_t>(std::max(0, axis_->currentIndex())); }

std::optional<double> ClipPanel::thickness() const
{
    bool good = false;
    const double number = fields_.at(thickness_field)->text().trimmed().toDouble(&good);
    return good && std::isfinite(number) && number > 0 ? std::optional(number) : std::nullopt;
}

void ClipPanel::show_box(const std::optional<ClipBox>& box, const Box3d& bounds, double step)
{
    box_ = box;
    step_ = step;
    bounds_ = bounds;
    const QSignalBlocker enabled(enabled_), side(side_);
    enabled_->setChecked(box && box->enabled);
    side_->setCurrentIndex(box && box->outside ? 1 : 0);
    const auto put = [&](Field field, const QString& text) {
        shown_[field] = text;
        fields_[field]->setText(text);
        fields_[field]->setEnabled(box.has_value());
    };
    for (int k = 0; k < 3; ++k) {
        const auto a = static_cast<std::size_t>(k);
        put(Field(centre_x + k), box ? QString::fromStdString(exact(box->centre[a])) : QString());
        put(Field(size_x + k), box ? QString::fromStdString(exact(2 * box->half[a])) : QString());
    }
    const auto degrees = box ? turn_of(*box) : std::nullopt;
    put(turn, degrees ? degrees_text(*degrees) : box ? "tilted" : "");
    enabled_->setEnabled(box.has_value());
    side_->setEnabled(box.has_value());
    for (const Button button : {Button::make_slab, Button::step_back, Button::step_ahead, Button::remove,
                                Button::keep_layer, Button::keep_file})
        buttons_[button]->setEnabled(box.has_value());
    show_slab(bounds);
}

void ClipPanel::show_slab(const Box3d& bounds)
{
    const QSignalBlocker slider(slider_);
    slider_->setEnabled(box_.has_value() && !bounds.empty());
    shown_[thickness_field] = box_ ? QString::fromStdString(exact(2 * box_->half[slab_axis()])) : QString();
    fields_[thickness_field]->setText(shown_[thickness_field]);
    if (!slider_->isEnabled()) return;
    const std::size_t axis = slab_axis();
    const double thickness = 2 * box_->half[axis];
    const auto range = range_along(bounds, box_->axes[axis]);
    slider_->setRange(0, static_cast<int>(std::clamp((range[1] - range[0]) / thickness, 0.0, double(most_steps))));
    const double place = (dot(box_->centre, box_->axes[axis]) - range[0]) / thickness - 0.5;
    slider_->setValue(static_cast<int>(std::clamp(std::round(place), 0.0, double(most_steps))));
}

void ClipPanel::show_steps(bool can_undo, bool can_redo)
{
    buttons_[Button::undo]->setEnabled(can_undo);
    buttons_[Button::redo]->setEnabled(can_redo);
}

void ClipPanel::say(const QString& text) { words_->say(text); }

// A number that was not edited keeps all of its digits.
void ClipPanel::take(Field field)
{
    QLineEdit* const edit = fields_[field];
    if (!box_ || edit->text() == shown_[field]) return;
    bool good = false;
    const double number = edit->text().trimmed().toDouble(&good);
    const bool is_size = field == thickness_field || (field >= size_x && field <= size_z);
    ClipBox box = *box_;
    if (good && std::isfinite(number) && !(is_size && !(number / 2 >= least_half(box)))) {
        say({});
        if (field <= centre_z)
            box.centre[std::size_t(field - centre_x)] = number;
        else if (field <= size_z)
            box.half[std::size_t(field - size_x)] = number / 2;
        else if (field == thickness_field)
            box.half[slab_axis()] = number / 2;
        else
            box.axes = turned(ClipBox(), number).axes;
        emit edited(box);
        return;
    }
    say("'" + edit->text() +
        (is_size ? "' is not a size: write a number above " + QString::fromStdString(brief(2 * least_half(box))) +
                       " in source units"
                 : "' is not a number: write one as in 123.45"));
    edit->setText(shown_[field]);
}

void ClipPanel::choose()
{
    if (!box_) return;
    ClipBox box = *box_;
    box.enabled = enabled_->isChecked();
    box.outside = side_->currentIndex() == 1;
    emit edited(box);
}

void ClipPanel::slide(int step)
{
    if (!box_ || bounds_.empty()) return;
    const Vec3d& axis = box_->axes[slab_axis()];
    const double to = range_along(bounds_, axis)[0] + (step + 0.5) * 2 * box_->half[slab_axis()];
    ClipBox box = *box_;
    box.centre = box.centre + (to - dot(box.centre, axis)) * axis;
    for (double& c : box.centre) c = decimal(c, step_ / 10);
    emit edited(box);
}

}  // namespace pcm::host
