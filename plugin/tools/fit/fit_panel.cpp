#include "plugin/tools/fit/fit_panel.h"

#include "pcm/system/text.h"
#include "plugin/panels/message_area.h"
#include "plugin/panels/named_list.h"
#include "plugin/panels/tool_dock.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/tools/fit/fit_fields.h"

#include <QGridLayout>
#include <QMenu>
#include <QPixmap>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>

#include <algorithm>

namespace pcm::host {

namespace {

constexpr int progress_steps = 1000;
constexpr int found_lines = 4, message_lines = 5;
constexpr int residual_digits = 3;
const char* const how_to =
    "Click a point of a surface. Ctrl+click adds a place that belongs to it; Shift+click or Alt+click one that does "
    "not. Dragging and the wheel move the camera.";

QIcon square(const QColor& colour)
{
    QPixmap picture(12, 12);
    picture.fill(colour);
    return QIcon(picture);
}

}  // namespace

FitPanel::FitPanel(QWidget* window) : QDockWidget("Fit Primitives", window)
{
    setObjectName("PointCloudFitDock");
    auto* form = new QWidget;
    auto* column = new QVBoxLayout(form);
    fields_ = new FitFields;
    column->addWidget(fields_);
    connect(fields_, &FitFields::changed, this, &FitPanel::settings_changed);
    add_draft(*column);
    add_list(*column);
    fill_dock(*this, form);
    show_found({}, false);
}

FitSettings FitPanel::settings() const { return fields_->settings(); }

void FitPanel::show_defaults() { fields_->show_defaults(); }

void FitPanel::add_button(QGridLayout& rows, int row, int column, Button button, const char* text, const char* tooltip)
{
    auto* widget = buttons_[button] = new QPushButton(text);
    widget->setToolTip(tooltip);
    widget->setFocusPolicy(Qt::NoFocus);  // Enter and Esc stay the view's
    widget->setMinimumWidth(40);
    connect(widget, &QPushButton::clicked, this, [this, button] { emit pressed(button); });
    rows.addWidget(widget, row, column);
}

void FitPanel::add_draft(QVBoxLayout& column)
{
    found_ = new MessageArea("PointCloudFitFound", found_lines);
    column.addWidget(found_);
    auto* buttons = new QGridLayout;
    add_button(*buttons, 0, 0, Button::accept, "Accept",
               "Puts the found shape into the list; one that is doubtful the second time. Enter in the view.");
    add_button(*buttons, 0, 1, Button::discard, "Discard",
               "Discards the found shape, or stops what runs. Esc in the view.");
    add_button(*buttons, 0, 2, Button::defaults, "Panel defaults",
               "Puts the fields above back to what they are at first; the list stays.");
    column.addLayout(buttons);
    progress_ = new QProgressBar;
    progress_->setObjectName("PointCloudFitProgress");
    progress_->setRange(0, progress_steps);
    keep_place(*progress_);
    progress_->hide();
    column.addWidget(progress_);
    words_ = new MessageArea("PointCloudFitMessage", message_lines);
    column.addWidget(words_);
}

void FitPanel::add_list(QVBoxLayout& column)
{
    list_ = new NamedList("PointCloudFitList", {"Name", "Size", "Residual", "Points"});
    list_->setToolTip(
        "The primitives of the project. The tick shows one in views; a double click on a name changes it. Residual: "
        "root mean square of its points' distances.");
    connect(list_, &NamedList::renamed, this, &FitPanel::renamed);
    connect(list_, &NamedList::hidden, this, &FitPanel::hidden);
    connect(list_, &NamedList::chosen, this, &FitPanel::selected);
    column.addWidget(list_, 3);
    auto* buttons = new QGridLayout;
    buttons->setHorizontalSpacing(4);
    add_button(*buttons, 0, 0, Button::look_at, "Jump to", "The camera looks at the selected primitive.");
    add_button(*buttons, 0, 1, Button::colour, "Colour",
               "The colour of the selected primitive, in views and drawings.");
    add_button(*buttons, 0, 2, Button::save, "Export",
               "Writes all primitives that are not hidden to a file, in source coordinates: DXF, SCR (a script for "
               "AutoCAD), CSV, or JSON, which reads back.");
    add_button(*buttons, 1, 0, Button::undo, "Undo", "Takes the last change of the list back. Ctrl+Z in the view.");
    add_button(*buttons, 1, 1, Button::redo, "Redo", "Repeats what was undone. Ctrl+Shift+Z in the view.");
    add_points_menu(*buttons, 1, 2);
    add_button(*buttons, 2, 0, Button::remove, "Delete",
               "Deletes the selected primitive from the list, not its points; Undo brings it back.");
    add_button(*buttons, 2, 1, Button::clear, "Delete all", "Deletes all primitives; Undo brings them back.");
    add_button(*buttons, 2, 2, Button::copy, "Copy",
               "Copies all that is known of the selected primitive, or of all, as text. Ctrl+C in the view.");
    column.addLayout(buttons);
    values_ = new ValueTable("PointCloudFitValues", "Selected primitive");
    values_->setToolTip(
        "All that is known of the selected primitive, with standard deviations. Angles are in degrees, lengths in the "
        "unit of the coordinates.");
    column.addWidget(values_, 3);
}

void FitPanel::add_points_menu(QGridLayout& rows, int row, int column)
{
    points_ = new QPushButton("Points");
    points_->setToolTip("What is done with the points of the selected primitive.");
    points_->setFocusPolicy(Qt::NoFocus);
    points_->setMinimumWidth(40);
    auto* menu = new QMenu(points_);
    const auto add = [&](Button button, const char* text, const char* tooltip) {
        QAction* action = menu->addAction(text);
        action->setToolTip(tooltip);
        connect(action, &QAction::triggered, this, [this, button] { emit pressed(button); });
    };
    menu->setToolTipsVisible(true);
    add(Button::select_points, "Select its points", "Selects them, as the tool Select Points does.");
    add(Button::to_layer, "Its points to a layer...", "Makes a new tree of them, shown in a layer of its own.");
    add(Button::to_file, "Its points to a file...", "Writes them to a file; the extension chooses the format.");
    add(Button::remove_points, "Delete its points...", "Deletes them from a copy of the tree, or in place.");
    add(Button::save_attribute, "Its points as an attribute...",
        "Saves an attribute in the tree that is 1 for these points and 0 for all others.");
    points_->setMenu(menu);
    rows.addWidget(points_, row, column);
}

void FitPanel::show_list(const PrimitiveList& list, std::optional<std::size_t> selected, const std::string& unit)
{
    std::vector<NamedList::Row> rows;
    const QString after = unit.empty() ? QString() : " " + QString::fromStdString(unit);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const Primitive& primitive = list[i];
        const QString size = size_of(primitive, unit);
        const QString rms = QString::number(primitive.fit.rms, 'g', residual_digits);
        const QString points = QString::fromStdString(grouped(primitive.points));
        // The standard deviation and the unit are among the values, and would be half of the panel's width here.
        rows.push_back({primitive.name,
                        primitive.hidden,
                        {size.section(QString(" ± "), 0, 0), rms, points},
                        square(colour_of(primitive)),
                        {size, rms + after, points}});
    }
    list_->show_rows(rows, selected);
    const bool some = selected.has_value();
    for (const Button button : {Button::look_at, Button::colour, Button::remove}) buttons_[button]->setEnabled(some);
    points_->setEnabled(some);
    buttons_[Button::clear]->setEnabled(!list.empty());
    buttons_[Button::save]->setEnabled(!list.empty());
    buttons_[Button::copy]->setEnabled(!list.empty());
    buttons_[Button::undo]->setEnabled(list.can_undo());
    buttons_[Button::redo]->setEnabled(list.can_redo());
    values_->show_values(some ? lines_of(list, *selected, unit) : std::vector<std::pair<QString, QString>>());
}

void FitPanel::show_found(const QString& text, bool some)
{
    found_->say(text.isEmpty() ? QString(how_to) : text);
    buttons_[Button::accept]->setEnabled(some);
}

void FitPanel::say(const QString& text) { words_->say(text); }

void FitPanel::show_progress(const std::optional<std::pair<QString, double>>& progress)
{
    progress_->setVisible(progress.has_value());
    if (!progress) return;
    progress_->setFormat(progress->first + " %p%");
    progress_->setValue(static_cast<int>(std::clamp(progress->second, 0.0, 1.0) * progress_steps));
}

}  // namespace pcm::host
