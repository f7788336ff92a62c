#include "plugin/settings/settings_dock.h"

#include "plugin/panels/window_menu.h"
#include "plugin/settings/settings.h"
#include "plugin/settings/stored_defaults.h"

#include <QAction>
#include <QApplication>
#include <QGridLayout>
#include <QMainWindow>
#include <QPushButton>
#include <QScrollArea>
#include <QSettings>
#include <QTimer>
#include <QToolButton>

namespace pcm::host {

namespace {

const char* const object_name = "PointCloudDock";
const char* const hidden_key = "PointCloud/panelHidden";
constexpr int panel_delay_ms = 400;  // MeshLab's panel is made anew; not at every step of a spin box

}  // namespace

void Dock::show_for(const SceneView& view)
{
    QMainWindow* const window = view.window();
    if (!window || window->findChild<QDockWidget*>(object_name)) return;
    auto* dock = new Dock(window, view.settings());
    window->addDockWidget(Qt::LeftDockWidgetArea, dock);
    dock->setVisible(!QSettings().value(hidden_key, false).toBool());
    add_to_menu(*window, "View", dock->toggleViewAction(), true);
    add_manual_to_help(*window);
    // Only by the user: MeshLab itself hides panels, too.
    connect(dock->toggleViewAction(), &QAction::triggered, dock,
            [](bool shown) { QSettings().setValue(hidden_key, !shown); });
}

Dock::Dock(QMainWindow* window, std::unique_ptr<SettingStore> settings)
    : QDockWidget("Point Cloud", window), settings_(std::move(settings))
{
    setObjectName(object_name);
    add_settings(defaults_);
    auto* scroll = new QScrollArea;
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    QWidget* const form = make_form();
    scroll->setWidget(form);
    scroll->setMinimumWidth(form->sizeHint().width() + 24);
    setWidget(scroll);
    refresh();
    // MeshLab's panel and its Tools > Options change the same settings.
    const char* const changed = "2dispatchCustomSettings(const RichParameterList&)";  // as the macro SIGNAL writes it
    connect(window, changed, this, SLOT(refresh()));
}

void Dock::closeEvent(QCloseEvent* event)
{
    QSettings().setValue(hidden_key, true);
    QDockWidget::closeEvent(event);
}

QWidget* Dock::make_form()
{
    Parameters first;
    add_first_settings(first);
    auto* form = new QWidget;
    auto* rows = new QGridLayout(form);
    auto* more = new QWidget(form);
    auto* more_rows = new QGridLayout(more);
    more_rows->setContentsMargins(0, 0, 0, 0);
    more->hide();
    const auto changed = [this](const QString& name, const QVariant& value) { apply(name, value); };
    for (const Parameter& setting : defaults_) {
        QGridLayout& into = first.has(setting.name) ? *rows : *more_rows;
        if (auto editor = add_setting_editor(into, setting, zero_is_off(setting.name), changed))
            editors_.push_back(std::move(editor));
    }
    auto* unfold = new QToolButton;
    unfold->setText("More settings");
    unfold->setCheckable(true);
    unfold->setAutoRaise(true);
    unfold->setArrowType(Qt::RightArrow);
    unfold->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    connect(unfold, &QToolButton::toggled, more, [more, unfold](bool on) {
        more->setVisible(on);
        unfold->setArrowType(on ? Qt::DownArrow : Qt::RightArrow);
    });
    auto* keep = new QPushButton("Keep");
    keep->setToolTip("Stores these settings for MeshLab's next start. A project keeps its settings in any case.");
    connect(keep, &QPushButton::clicked, this, &Dock::store);
    auto* back = new QPushButton("Defaults");
    back->setToolTip("Sets all settings to what they were before the first start.");
    connect(back, &QPushButton::clicked, this, &Dock::reset);
    const int end = rows->rowCount();
    rows->addWidget(unfold, end, 0, 1, 2);
    rows->addWidget(more, end + 1, 0, 1, 2);
    rows->addWidget(keep, end + 2, 0);
    rows->addWidget(back, end + 2, 1);
    rows->setRowStretch(end + 3, 1);
    return form;
}

void Dock::refresh()
{
    for (const auto& editor : editors_)
        if (const auto value = settings_->value(editor->name())) editor->show(*value);
}

void Dock::apply(const QString& name, const QVariant& value)
{
    settings_->set(name, value);
    redraw();
}

void Dock::redraw()
{
    for (QWidget* widget : QApplication::allWidgets())
        if (widget->inherits("GLArea")) widget->update();
    if (panel_is_old_) return;
    panel_is_old_ = true;
    QTimer::singleShot(panel_delay_ms, this, [this] {
        panel_is_old_ = false;
        QMetaObject::invokeMethod(parent(), "updateLayerDialog");
    });
}

// As the button Save of MeshLab's panel does.
void Dock::store()
{
    for (const auto& editor : editors_) {
        settings_->store(editor->name());
        keep_stored(editor->name());
    }
}

void Dock::reset()
{
    for (const Parameter& setting : defaults_) settings_->set(setting.name, setting.value);
    refresh();
    redraw();
}

}  // namespace pcm::host
