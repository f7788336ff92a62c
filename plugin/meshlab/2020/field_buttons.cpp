#include "plugin/meshlab/2020/field_buttons.h"

#include "pcm/io/formats.h"
#include "pcm/system/text.h"
#include "pcm/system/tree_folder.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/view_box.h"
#include "plugin/scene/scene_state.h"

#include <QAction>
#include <QApplication>
#include <QFileDialog>
#include <QFileInfo>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>
#include <QPointer>
#include <QStyle>
#include <QTimer>

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

// A tree where nothing else is said.
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

void take_view(QLineEdit& field, MeshDocument& document)
{
    const MeshModel* layer = document.mm();
    for (GLArea* view : views_of(document)) {
        if (!layer || !view->isVisible() || (!view->isCurrent() && views_of(document).size() > 1)) continue;
        const double aspect = static_cast<double>(view->width()) / std::max(view->height(), 1);
        write_box(field, box_in_view(*layer, pose_of(view->trackball.track, view->fov), view->fov, aspect),
                  "The view shows no point of the current layer.");
        return;
    }
}

void take_selection(QLineEdit& field, MeshDocument& document)
{
    if (const MeshModel* layer = document.mm())
        write_box(field, box_of_selection(*layer),
                  "No vertex of the current layer is selected. Select some with MeshLab's tools; of a point cloud tree "
                  "they select in its sample.");
}

void take_clip_box(QLineEdit& field, MeshDocument& document)
{
    const auto& clip = scene_of(document).part<SceneState>().clip();
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

std::vector<Button> buttons_of(const RichParameter& of, MeshDocument* document)
{
    const QString parameter = of.name();
    // "Output folder" is a tree; "Output" may be a file too.
    if (parameter == "PointsOutput" || (parameter == "Output" && of.fieldDescription() == "Output"))
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
    if (parameter != "Box" || !document) return {};
    // The document may be closed while the dialog is open.
    const QPointer<MeshDocument> alive(document);
    const auto from = [alive](void (*take)(QLineEdit&, MeshDocument&)) {
        return [alive, take](QLineEdit& field) {
            if (alive) take(field, *alive);
        };
    };
    return {{QStyle::SP_ComputerIcon, "Box of what the view shows", from(take_view)},
            {QStyle::SP_FileDialogListView, "Box of the selected vertices", from(take_selection)},
            {QStyle::SP_FileDialogContentsView, "Box around the clip box", from(take_clip_box)}};
}

// MeshLab's frame of parameters has a row for each: a label with its description, and the field.
void add_to_frame(const QGridLayout& rows, const std::map<QString, std::vector<Button>>& buttons)
{
    for (int row = 0; row < rows.rowCount(); ++row) {
        const auto widget_at = [&](int column) {
            QLayoutItem* item = rows.itemAtPosition(row, column);
            return item ? item->widget() : nullptr;
        };
        const auto* label = qobject_cast<QLabel*>(widget_at(0));
        auto* field = qobject_cast<QLineEdit*>(widget_at(1));
        const auto found = label ? buttons.find(label->text()) : buttons.end();
        if (!field || found == buttons.end() || !field->actions().isEmpty()) continue;
        for (const Button& button : found->second) {
            auto* action = field->addAction(field->style()->standardIcon(button.icon), QLineEdit::TrailingPosition);
            action->setText(button.text);
            action->setToolTip(button.text);
            QObject::connect(action, &QAction::triggered, field, [field, press = button.press] { press(*field); });
        }
    }
}

}  // namespace

void add_field_buttons(const RichParameterList& parameters, MeshDocument* document)
{
    if (QApplication::topLevelWidgets().isEmpty()) return;
    std::map<QString, std::vector<Button>> buttons;  // by the fields' labels
    for (const RichParameter& parameter : parameters)
        if (auto some = buttons_of(parameter, document); !some.empty())
            buttons[parameter.fieldDescription()] = std::move(some);
    if (buttons.empty()) return;
    QTimer::singleShot(0, qApp, [buttons] {
        for (const QWidget* widget : QApplication::allWidgets())
            if (widget->inherits("RichParameterListFrame") && widget->isVisible())
                if (const auto* rows = qobject_cast<QGridLayout*>(widget->layout())) add_to_frame(*rows, buttons);
    });
}

}  // namespace pcm::host
