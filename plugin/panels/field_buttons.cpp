#include "plugin/panels/field_buttons.h"

#include "pcm/io/formats.h"
#include "pcm/system/text.h"
#include "pcm/system/tree_folder.h"
#include "plugin/panels/program_form.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/scene_view.h"
#include "plugin/scene/view_box.h"

#include <QAction>
#include <QApplication>
#include <QFileDialog>
#include <QFileInfo>
#include <QLineEdit>
#include <QMessageBox>
#include <QPointer>
#include <QStyle>
#include <QWidget>

#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace pcm::host {

namespace {

// Writes what the user has chosen into the field; leaves the field alone if the choice is cancelled.
using Press = std::function<void(QLineEdit& field)>;

struct Button {
    QStyle::StandardPixmap icon;
    const char* text;
    Press press;
};

void write(QLineEdit& field, const QString& text)
{
    field.setText(text);
    QMetaObject::invokeMethod(&field, "editingFinished");  // MeshLab notices
}

// Where a dialog starts: at what the field has.
QString beginning(const QLineEdit& field) { return field.text().section(';', -1).trimmed(); }

QString readable_files()
{
    QStringList patterns;
    for (const std::string& extension : readable_extensions())
        patterns << "*." + QString::fromStdString(extension) << "*." + QString::fromStdString(extension).toUpper();
    return "Point clouds (" + patterns.join(' ') + ");;All files (*)";
}

void add_paths(QLineEdit& field, const QStringList& paths)
{
    if (paths.isEmpty()) return;
    const QString before = field.text().trimmed();
    write(field, before.isEmpty() ? paths.join("; ") : before + "; " + paths.join("; "));
}

void pick_files(QLineEdit& field)
{
    add_paths(field, QFileDialog::getOpenFileNames(field.window(), "Add point cloud files", beginning(field),
                                                   readable_files()));
}

void pick_folder_of_files(QLineEdit& field)
{
    const QString folder =
        QFileDialog::getExistingDirectory(field.window(), "Add a folder of point cloud files", beginning(field));
    if (!folder.isEmpty()) add_paths(field, {folder});
}

void pick_folder(QLineEdit& field)
{
    const QString folder = QFileDialog::getExistingDirectory(field.window(), "Choose a folder", field.text());
    if (!folder.isEmpty()) write(field, folder);
}

// The folder of the tree or any file in it, such as its index; empty: cancelled.
QString picked_tree(QLineEdit& field)
{
    QFileDialog dialog(field.window(), "Choose the index.pct in the folder of a point cloud tree", beginning(field));
    dialog.setFileMode(QFileDialog::ExistingFile);
    dialog.setNameFilter("Point cloud tree (index.pct)");
    if (dialog.exec() != QDialog::Accepted || dialog.selectedFiles().isEmpty()) return {};
    return QString::fromStdString(tree_folder_of(dialog.selectedFiles().first().toStdString()).string());
}

void pick_tree(QLineEdit& field)
{
    const QString tree = picked_tree(field);
    if (!tree.isEmpty()) write(field, tree);
}

void add_tree(QLineEdit& field)
{
    const QString tree = picked_tree(field);
    if (!tree.isEmpty()) add_paths(field, {tree});
}

void pick_new_tree(QLineEdit& field)
{
    // What is there already is the filter's concern.
    const QString folder =
        QFileDialog::getSaveFileName(field.window(), "Name a point cloud tree", field.text(),
                                     "Point cloud tree (*.pct)", nullptr, QFileDialog::DontConfirmOverwrite);
    if (!folder.isEmpty()) write(field, folder.endsWith(".pct", Qt::CaseInsensitive) ? folder : folder + ".pct");
}

void pick_new_file(QLineEdit& field)
{
    // What is there already is the filter's concern.
    const QString file = QFileDialog::getSaveFileName(field.window(), "Name a file", field.text(), "All files (*)",
                                                      nullptr, QFileDialog::DontConfirmOverwrite);
    if (!file.isEmpty()) write(field, file);
}

// A tree unless another kind is declared.
void pick_new_tree_or_file(QLineEdit& field)
{
    // What is there already is the filter's concern.
    const QString path = QFileDialog::getSaveFileName(field.window(), "Name a point cloud tree or a file", field.text(),
                                                      "Point cloud tree (*.pct);;All files (*)", nullptr,
                                                      QFileDialog::DontConfirmOverwrite);
    if (!path.isEmpty()) write(field, QFileInfo(path).suffix().isEmpty() ? path + ".pct" : path);
}

void pick_existing(QLineEdit& field, const QString& title, const QString& files)
{
    const QString file = QFileDialog::getOpenFileName(field.window(), title, field.text(), files);
    if (!file.isEmpty()) write(field, file);
}

void pick_list(QLineEdit& field) { pick_existing(field, "Choose a list", "Lists (*.json)"); }
void pick_pairs(QLineEdit& field)
{
    pick_existing(field, "Choose a file of pairs", "Pairs (*.txt *.csv);;All files (*)");
}

void write_box(QLineEdit& field, const std::optional<Box3d>& box, const QString& if_none)
{
    if (box)
        write(field, box_text(*box));
    else
        QMessageBox::information(field.window(), "Point cloud", if_none);
}

void take_view(QLineEdit& field, Scene& scene)
{
    const SceneLayer* const layer = scene.current();
    const auto views = scene.views();
    for (const SceneView* view : views) {
        if (!layer || !view->widget().isVisible() || (!view->is_current() && views.size() > 1)) continue;
        write_box(field, view->seen_box(*layer), "The view shows no point of the current layer.");
        return;
    }
}

void take_selection(QLineEdit& field, Scene& scene)
{
    if (const SceneLayer* const layer = scene.current())
        write_box(field, box_of_selection(*layer),
                  "No vertex of the current layer is selected. Select some with MeshLab's tools; of a point cloud tree "
                  "they select in its sample.");
}

void take_clip_box(QLineEdit& field, Scene& scene)
{
    const auto& clip = scene.part<SceneState>().clip();
    if (!clip) {
        QMessageBox::information(field.window(), "Point cloud", "The project has no clip box.");
        return;
    }
    Box3d box;
    for (std::size_t a = 0; a < 3; ++a) {
        double reach = 0;
        for (std::size_t k = 0; k < 3; ++k) reach += std::fabs(clip->axes[k][a]) * clip->half[k];
        box.min[a] = clip->centre[a] - reach;
        box.max[a] = clip->centre[a] + reach;
    }
    write(field, QString::fromStdString(exact(box.min) + " " + exact(box.max)));
}

std::vector<Button> buttons_of(const Parameter& of, Scene* scene)
{
    const QString& parameter = of.name;
    // "Output folder" is a tree; "Output" may be a file too.
    if (parameter == "PointsOutput" || (parameter == "Output" && of.label == "Output"))
        return {{QStyle::SP_DialogSaveButton, "Name a tree or a file", pick_new_tree_or_file}};
    if (parameter == "Inputs")
        return {{QStyle::SP_DirIcon, "Add a folder", pick_folder_of_files},
                {QStyle::SP_FileIcon, "Add files", pick_files}};
    if (parameter == "OutputFile") return {{QStyle::SP_DialogSaveButton, "Name a file", pick_new_file}};
    if (parameter == "ListFile") return {{QStyle::SP_DirOpenIcon, "Choose a list", pick_list}};
    if (parameter == "PairsFile") return {{QStyle::SP_DirOpenIcon, "Choose a file of pairs", pick_pairs}};
    if (parameter == "Trees") return {{QStyle::SP_DirOpenIcon, "Add a tree", add_tree}};
    if (parameter == "Tree" || parameter == "TreeBefore") return {{QStyle::SP_DirOpenIcon, "Choose a tree", pick_tree}};
    if (parameter == "Output") return {{QStyle::SP_DirOpenIcon, "Name a tree", pick_new_tree}};
    if (parameter.section("::", -1) == "TreeFolder") return {{QStyle::SP_DirOpenIcon, "Choose a folder", pick_folder}};
    if (parameter != "Box" || !scene) return {};
    // The scene may be closed while the dialog is open.
    const QPointer<Scene> alive(scene);
    const auto from = [alive](void (*take)(QLineEdit&, Scene&)) {
        return [alive, take](QLineEdit& field) {
            if (alive) take(field, *alive);
        };
    };
    return {{QStyle::SP_ComputerIcon, "Box of what the view shows", from(take_view)},
            {QStyle::SP_FileDialogListView, "Box of the selected vertices", from(take_selection)},
            {QStyle::SP_FileDialogContentsView, "Box around the clip box", from(take_clip_box)}};
}

void add_buttons(QLineEdit& field, const std::vector<Button>& buttons)
{
    for (const Button& button : buttons) {
        auto* action = field.addAction(field.style()->standardIcon(button.icon), QLineEdit::TrailingPosition);
        action->setText(button.text);
        action->setToolTip(button.text);
        QObject::connect(action, &QAction::triggered, &field, [&field, press = button.press] { press(field); });
    }
}

}  // namespace

void add_field_buttons(const Parameters& parameters, Scene* scene)
{
    if (QApplication::topLevelWidgets().isEmpty()) return;
    struct Added {
        std::vector<Button> buttons;
        QString empty;
    };
    std::map<QString, Added> by_label;
    for (const Parameter& parameter : parameters) {
        Added added{buttons_of(parameter, scene), parameter.empty};
        if (!added.buttons.empty() || !added.empty.isEmpty()) by_label[parameter.label] = std::move(added);
    }
    if (by_label.empty()) return;
    when_form_is_shown(*qApp, [by_label](const QGridLayout& rows) {
        for (const auto& [label, added] : by_label) {
            QLineEdit* const field = field_in(rows, label);
            if (!field) continue;
            field->setPlaceholderText(added.empty);
            if (field->actions().isEmpty()) add_buttons(*field, added.buttons);
        }
    });
}

}  // namespace pcm::host
