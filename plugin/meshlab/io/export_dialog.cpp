#include "plugin/meshlab/io/export_dialog.h"

#include "pcm/io/formats.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/meshlab.h"

#include <QAction>
#include <QApplication>
#include <QFileDialog>
#include <QMainWindow>
#include <QTimer>

#include <unistd.h>

namespace pcm::host {

namespace {

const char* const proposed_extension = "laz";

QString text_of(const std::filesystem::path& path) { return QString::fromStdString(path.string()); }

// "LAZ compressed LAS (*.laz)" of every format that can be written; `proposed` is the one of the extension.
QStringList name_filters(const QString& extension, QString& proposed)
{
    QStringList filters;
    for (const Format& format : formats()) {
        if (!format.create) continue;
        for (const std::string_view one : format.extensions) {
            if (one.empty()) continue;
            const QString name = QString::fromStdString(std::string(one));
            filters << name.toUpper() + " " + QString::fromStdString(std::string(format.label)) + " (*." + name + ")";
            if (name == extension) proposed = filters.last();
        }
    }
    return filters;
}

QString extension_of_filter(const QString& filter) { return filter.section("(*.", -1).remove(')'); }

QString ask_for_file(QWidget* window, const SceneLayer& layer, const std::filesystem::path& tree)
{
    std::filesystem::path file = proposed_export(tree);
    if (access(file.parent_path().c_str(), W_OK) != 0) file = file.filename();  // in the current folder
    QString proposed;
    const QStringList filters = name_filters(proposed_extension, proposed);
    QFileDialog dialog(window, "Export \"" + layer.label() + "\"", text_of(file.parent_path()));
    dialog.setAcceptMode(QFileDialog::AcceptSave);
    dialog.setNameFilters(filters);
    dialog.selectNameFilter(proposed);
    dialog.setDefaultSuffix(proposed_extension);
    dialog.selectFile(text_of(file.filename()));
    // Another type: the name follows.
    QObject::connect(&dialog, &QFileDialog::filterSelected, &dialog, [&dialog](const QString& filter) {
        dialog.setDefaultSuffix(extension_of_filter(filter));
        if (!dialog.selectedFiles().isEmpty())
            dialog.selectFile(QFileInfo(dialog.selectedFiles().first()).completeBaseName() + "." +
                              extension_of_filter(filter));
    });
    if (dialog.exec() != QDialog::Accepted || dialog.selectedFiles().isEmpty()) return {};
    return dialog.selectedFiles().first();
}

}  // namespace

std::filesystem::path proposed_export(const std::filesystem::path& tree)
{
    const std::filesystem::path folder = tree.parent_path();
    const std::string name = tree.stem().string(), extension = std::string(".") + proposed_extension;
    std::error_code ignored;
    const auto is_free = [&](const std::filesystem::path& file) { return !std::filesystem::exists(file, ignored); };
    std::filesystem::path file = folder / (name + extension);
    if (is_free(file)) return file;
    file = folder / (name + "-export" + extension);
    for (int number = 2; !is_free(file) && number < 1000; ++number)
        file = folder / (name + "-export-" + std::to_string(number) + extension);
    return file;
}

void ExportDialog::take_over(const SceneView& view)
{
    QMainWindow* const window = view.window();
    if (window && !window->findChild<ExportDialog*>(QString(), Qt::FindDirectChildrenOnly)) new ExportDialog(window);
}

ExportDialog::ExportDialog(QMainWindow* window) : QObject(window), window_(window)
{
    take("Export Mesh...", "save");
    take("Export Mesh As...", "saveAs");
}

void ExportDialog::take(const char* text, const char* slot)
{
    for (QAction* action : window_->findChildren<QAction*>(QString(), Qt::FindDirectChildrenOnly)) {
        if (action->text().remove('&') != text) continue;
        const QByteArray theirs = '1' + QByteArray(slot) + "()";  // as the macro SLOT writes it
        if (disconnect(action, SIGNAL(triggered()), window_, theirs.constData()))
            connect(action, &QAction::triggered, this, [this, slot] { export_current(slot); });
    }
}

void ExportDialog::export_current(const char* slot)
{
    const SceneView* const view = current_view(*window_);
    const SceneLayer* const layer = view ? view->scene().current() : nullptr;
    const auto tree = layer ? layer->tree() : std::nullopt;
    if (!tree) {
        QMetaObject::invokeMethod(window_, slot);
        return;
    }
    const QString file = ask_for_file(window_, *layer, tree->cloud->tree()->folder());
    if (!file.isEmpty()) QMetaObject::invokeMethod(window_, "saveAs", Q_ARG(QString, file), Q_ARG(bool, false));
}

void hide_unread_ticks(const SceneLayer& layer)
{
    if (QApplication::topLevelWidgets().isEmpty()) return;
    const bool is_tree = layer.tree().has_value();
    QTimer::singleShot(0, qApp, [is_tree] {
        QWidget* const dialog = QApplication::activeModalWidget();
        if (!dialog || !dialog->inherits(save_dialog)) return;
        static const QStringList read{"check_iom_vertcolor", "check_iom_vertnormal", "check_iom_vertquality",
                                      "check_iom_vertradius"};
        for (QWidget* widget : dialog->findChildren<QWidget*>()) {
            const QString name = widget->objectName();
            const bool is_tick = name.startsWith("check_iom_") && (is_tree || !read.contains(name));
            const bool is_choice = is_tree && (name == "AllButton" || name == "NoneButton");
            // Faces, wedges, textures; of a tree the vertices' group too.
            const bool is_group = name.startsWith("groupBox") && (is_tree || name != "groupBox");
            if (is_tick || is_choice || is_group) widget->hide();
        }
        dialog->adjustSize();
    });
}

void keep_file_of(SceneLayer& layer)
{
    // A file with the matrix applied and the layer's matrix together would move the points twice in a project.
    if (!QCoreApplication::instance() || (!layer.tree() && layer.matrix() == identity_matrix)) return;
    Scene& scene = layer.scene();
    QTimer::singleShot(0, &scene, [&scene, id = layer.id(), file = layer.file()] {
        SceneLayer* const shown = scene.layer(id);
        if (!shown || shown->file() == file) return;
        shown->set_file(file);
        scene.refresh_layer_lists();
    });
}

}  // namespace pcm::host
