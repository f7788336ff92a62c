#include "plugin/tools/select/select_panel.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/panels/message_area.h"
#include "plugin/panels/tool_dock.h"

#include <QAction>
#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr double least_brush_px = 1, largest_brush_px = 1000;

constexpr int count_lines = 4, message_lines = 4;
const char* const automatic = "automatic";

double number_in(const QString& text, const char* what, bool may_be_zero)
{
    bool good = false;
    const double number = text.trimmed().toDouble(&good);
    if (good && std::isfinite(number) && (number > 0 || (may_be_zero && number == 0))) return number;
    throw Error(ErrorCode::invalid_argument, {}, "'" + text.toStdString() + "' is not " + what,
                may_be_zero ? "write a number from 0 on, as in 20" : "write a number above 0, as in 0.25");
}

}  // namespace

SelectPanel::SelectPanel(QWidget* window) : QDockWidget("Select Points", window)
{
    setObjectName("PointCloudSelectDock");
    auto* form = new QWidget;
    auto* rows = new QGridLayout(form);
    add_ways(*rows);
    add_uses(*rows);
    words_ = new MessageArea("PointCloudSelectMessage", message_lines);
    rows->addWidget(words_, rows->rowCount(), 0, 1, 3);
    rows->setRowStretch(rows->rowCount(), 1);
    fill_dock(*this, form);
    show_fields();
}

QComboBox* SelectPanel::add_choice(QGridLayout& rows, const char* label, const QStringList& choices,
                                   const char* tooltip)
{
    auto* box = new QComboBox;
    box->addItems(choices);
    box->setToolTip(tooltip);
    auto* words = new QLabel(label);
    words->setToolTip(tooltip);
    const int row = rows.rowCount();
    rows.addWidget(words, row, 0);
    rows.addWidget(box, row, 1, 1, 2);
    parts_[box] = {words, box};
    return box;
}

QLineEdit* SelectPanel::add_field(QGridLayout& rows, const char* label, const char* usual, const char* tooltip)
{
    auto* edit = new QLineEdit;
    edit->setPlaceholderText(usual);
    edit->setToolTip(tooltip);
    auto* words = new QLabel(label);
    words->setToolTip(tooltip);
    const int row = rows.rowCount();
    rows.addWidget(words, row, 0);
    rows.addWidget(edit, row, 1, 1, 2);
    parts_[edit] = {words, edit};
    return edit;
}

void SelectPanel::add_button(QGridLayout& rows, int row, int column, Button button, const char* text,
                             const char* tooltip)
{
    auto* widget = buttons_[button] = new QPushButton(text);
    widget->setToolTip(tooltip);
    connect(widget, &QPushButton::clicked, this, [this, button] { emit pressed(button); });
    rows.addWidget(widget, row, column);
}

void SelectPanel::add_ways(QGridLayout& rows)
{
    shape_ = add_choice(rows, "Select by", {"Rectangle", "Polygon or lasso", "Brush", "Grow"},
                        "Rectangle: drag. Polygon or lasso: click corners, double click or Enter closes it; or drag "
                        "around the points. Brush: drag over a surface. Grow: click a point; all points that can be "
                        "reached from it in short steps. Only points that the view shows are selected: those that the "
                        "clip box, hidden classes or conditions hide are not. Default Rectangle.");
    operation_ = add_choice(rows, "Operation", {"Replace", "Add", "Subtract", "Intersect"},
                            "What is done with the points selected before. Keys: Shift adds, Ctrl subtracts, both "
                            "intersect. Default Replace.");
    reach_ = add_choice(rows, "Depth", {"Through the cloud", "Front only"},
                        "Whether a rectangle or polygon selects all points that it covers, or only those that are "
                        "visible from here, in front of all others. Default Through the cloud.");
    layers_ =
        add_choice(rows, "Layers", {"Current layer", "All shown layers"},
                   "Which clouds a selection is made in: the current layer (for a brush, those that it meets), or "
                   "all that the view shows and that are not locked. Growing stays in the cloud that is clicked. "
                   "Default Current layer.");
    brush_ = add_field(rows, "Brush radius", automatic,
                       "Pixels of the screen: points within a ball of this radius around the surface under the cursor "
                       "are selected. 1 to 1000. Default: automatic, 15, and more where the points are so far apart "
                       "that it would hold few of them; the ring in the view shows it.");
    add_growing(rows);
    where_ = add_field(rows, "Condition", "none",
                       "Points whose attributes meet conditions, separated by ; as in classification=2,6; "
                       "intensity>=100; z=400..450. Default: none.");
    attributes_ = new QComboBox;
    attributes_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    attributes_->setToolTip("The attributes of the cloud; a chosen one is added to the condition.");
    const int row = rows.rowCount();
    rows.addWidget(attributes_, row, 1);
    connect(attributes_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
        if (index == 0) return;
        const QString before = where_->text().trimmed();
        where_->setText(before + (before.isEmpty() || before.endsWith(';') ? "" : "; ") + attributes_->currentText());
        where_->setFocus();
        attributes_->setCurrentIndex(0);
    });
    add_button(rows, row, 2, Button::where, "By condition", "Selects the shown points that meet the condition.");
    // Two columns: a panel is narrow.
    auto* buttons = new QGridLayout;
    rows.addLayout(buttons, row + 1, 0, 1, 3);
    add_button(*buttons, 0, 0, Button::all, "Select shown", "Selects all points that the view shows.");
    add_button(*buttons, 0, 1, Button::none, "Select none", "Selects nothing. Undo brings the selection back.");
    add_button(*buttons, 1, 0, Button::invert, "Invert selection", "Selects the shown points that were not selected.");
    add_button(*buttons, 1, 1, Button::colour, "Colour...",
               "The colour in which views show selected points. It is kept for later sessions. Default #ff400d.");
    connect(shape_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] {
        show_fields();
        emit shape_changed();
    });
}

void SelectPanel::add_growing(QGridLayout& rows)
{
    distance_ = add_field(rows, "Grow distance", automatic,
                          "The longest step from point to point, in source units. Default: automatic, about three "
                          "times the spacing of the points around the one that is clicked.");
    angle_ = add_field(rows, "Normals within", "not compared",
                       "Only points whose normal is within this angle of the clicked point's, of either sign, "
                       "degrees: 20 keeps to a roof's side. Default: not compared. Needs normals in the cloud.");
    difference_ = add_field(rows, "Colours within", "not compared",
                            "Only points whose colour is this near to the clicked point's: the distance between red, "
                            "green and blue of 0 to 255 each, 0 to 441.7. Default: not compared.");
    within_ = add_field(rows, "Not farther than", "no limit",
                        "Only points this near to the clicked one, in source units. Default: no limit.");
}

void SelectPanel::show_fields()
{
    const Shape now = shape();
    const bool is_drawn = now == Shape::rectangle || now == Shape::lasso, grows = now == Shape::grow;
    const std::map<QWidget*, bool> shown{{reach_, is_drawn}, {layers_, !grows}, {brush_, now == Shape::brush},
                                         {distance_, grows}, {angle_, grows},   {difference_, grows},
                                         {within_, grows}};
    for (const auto& [field, is_shown] : shown)
        for (QWidget* part : parts_[field]) part->setVisible(is_shown);
}

void SelectPanel::show_defaults()
{
    for (QComboBox* choice : {shape_, operation_, reach_, layers_}) choice->setCurrentIndex(0);
    for (QLineEdit* field : {brush_, distance_, angle_, difference_, within_, where_}) field->clear();
}

void SelectPanel::add_uses(QGridLayout& rows)
{
    count_ = new MessageArea("PointCloudSelectCount", count_lines);
    count_->say("Nothing is selected");
    int row = rows.rowCount();
    rows.addWidget(count_, row++, 0, 1, 3);
    progress_ = new QProgressBar;
    progress_->setRange(0, 1000);
    progress_->hide();
    keep_place(*progress_);
    rows.addWidget(progress_, row, 0, 1, 2);
    add_button(rows, row++, 2, Button::stop, "Stop", "Cancels the current operation; keeps the selection. Key: Esc.");
    keep_place(*buttons_[Button::stop]);
    buttons_[Button::stop]->hide();
    auto* buttons = new QGridLayout;
    rows.addLayout(buttons, row, 0, 1, 3);
    add_button(*buttons, 0, 0, Button::undo, "Undo selection", "Takes the last change back. Ctrl+Z.");
    add_button(*buttons, 0, 1, Button::redo, "Redo selection", "Repeats what was undone. Ctrl+Shift+Z.");
    add_button(*buttons, 1, 0, Button::to_layer, "To a layer",
               "Makes a new tree of the selected points, with all attributes, and shows it in a layer.");
    add_button(*buttons, 1, 1, Button::to_file, "To a file",
               "Writes the selected points to a file; the extension chooses the format.");
    add_button(*buttons, 2, 0, Button::remove, "Delete points",
               "Deletes the selected points: makes a copy of the tree without them, or changes the tree in place.");
    add_button(*buttons, 2, 1, Button::classify, "Classify", "Gives the selected points a class.");
    add_button(*buttons, 3, 0, Button::save, "Save as attribute",
               "Saves the selection in the tree: an attribute that is 1 for selected points and 0 for all others. The "
               "condition NAME=1 selects them again.");
    add_button(*buttons, 3, 1, Button::defaults, "Panel defaults",
               "Puts all fields of this panel back to what they are in a new project; the selection stays.");
    show_steps({}, {});
}

SelectPanel::Shape SelectPanel::shape() const { return static_cast<Shape>(std::max(0, shape_->currentIndex())); }

SetOperation SelectPanel::operation() const
{
    return static_cast<SetOperation>(std::max(0, operation_->currentIndex()));
}

bool SelectPanel::front_only() const { return reach_->currentIndex() == 1; }

bool SelectPanel::all_layers() const { return layers_->currentIndex() == 1; }

std::optional<double> SelectPanel::brush_px() const
{
    if (brush_->text().trimmed().isEmpty()) return std::nullopt;
    return std::clamp(number_in(brush_->text(), "a brush radius", false), least_brush_px, largest_brush_px);
}

std::optional<double> SelectPanel::distance() const
{
    if (distance_->text().trimmed().isEmpty()) return std::nullopt;
    return number_in(distance_->text(), "a grow distance", false);
}

SeedLimits SelectPanel::seed_limits() const
{
    SeedLimits limits;
    const auto typed = [](const QLineEdit& field, const char* what) {
        return field.text().trimmed().isEmpty() ? std::nullopt
                                                : std::make_optional(number_in(field.text(), what, true));
    };
    limits.normal_angle = typed(*angle_, "an angle between normals");
    if (limits.normal_angle && *limits.normal_angle > 90)
        throw Error(ErrorCode::invalid_argument, {}, "normals within " + exact(*limits.normal_angle) + " degrees",
                    "write an angle from 0 to 90, as in 20, or empty the field");
    if (limits.normal_angle) *limits.normal_angle *= pi / 180;
    limits.colour_difference = typed(*difference_, "a difference of colours");
    limits.within = typed(*within_, "a distance");
    return limits;
}

void SelectPanel::propose_distance(const QString& text)
{
    distance_->setPlaceholderText(text.isEmpty() ? automatic : text);
}

QString SelectPanel::where() const { return where_->text().trimmed(); }

void SelectPanel::show_colour(const QColor& colour)
{
    QPixmap sample(32, 12);
    sample.fill(colour);
    buttons_[Button::colour]->setIcon(sample);
    buttons_[Button::colour]->setIconSize(sample.size());
}

void SelectPanel::show_count(const QString& text) { count_->say(text); }

void SelectPanel::show_attributes(const QStringList& names)
{
    QStringList before;
    for (int i = 1; i < attributes_->count(); ++i) before << attributes_->itemText(i);
    if (before == names && attributes_->count() > 0) return;
    attributes_->clear();
    attributes_->addItem("Attributes");
    attributes_->addItems(names);
}

void SelectPanel::show_steps(const QString& undo, const QString& redo)
{
    buttons_[Button::undo]->setEnabled(!undo.isNull());
    buttons_[Button::redo]->setEnabled(!redo.isNull());
    buttons_[Button::undo]->setToolTip("Takes back: " + (undo.isNull() ? "nothing" : undo) + ". Ctrl+Z.");
    buttons_[Button::redo]->setToolTip("Repeats: " + (redo.isNull() ? "nothing" : redo) + ". Ctrl+Shift+Z.");
}

void SelectPanel::show_progress(double fraction, const QString& stage)
{
    progress_->show();
    buttons_[Button::stop]->show();
    progress_->setValue(static_cast<int>(std::clamp(fraction, 0.0, 1.0) * 1000));
    progress_->setFormat(stage.isEmpty() ? "%p %" : stage + " %p %");
}

void SelectPanel::end_progress()
{
    progress_->hide();
    buttons_[Button::stop]->hide();
}

void SelectPanel::say(const QString& text) { words_->say(text); }

}  // namespace pcm::host
