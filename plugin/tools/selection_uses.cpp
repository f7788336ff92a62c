#include "plugin/tools/selection_uses.h"

#include "pcm/cloud/las_class.h"
#include "pcm/filter/set_changes.h"
#include "pcm/filter/set_points.h"
#include "pcm/select/select_points.h"
#include "pcm/system/error.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/free_path.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/shown_points.h"
#include "plugin/scene/text.h"

#include <QComboBox>
#include <QDialog>
#include <QDialogButtonBox>
#include <QFileDialog>
#include <QInputDialog>
#include <QLabel>
#include <QLineEdit>
#include <QMainWindow>
#include <QMessageBox>
#include <QPushButton>
#include <QStatusBar>
#include <QVBoxLayout>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

namespace {

namespace fs = std::filesystem;

const char* const trees = "Point cloud tree (*.pct)";

QStatusBar* status_bar = nullptr;  // during an operation

bool show_status(const int percent, const char* text)
{
    if (status_bar) status_bar->showMessage(QString("%1 % %2 (Esc cancels)").arg(percent).arg(text));
    return true;
}

// Shows the progress in the window's status bar.
class ShownOperation {
public:
    explicit ShownOperation(QMainWindow* window)
        : operation_((status_bar = window ? window->statusBar() : nullptr, show_status))
    {
    }
    ~ShownOperation()
    {
        if (status_bar) status_bar->clearMessage();
        status_bar = nullptr;
    }
    ProgressFunction progress() { return operation_.progress(); }

private:
    Operation operation_;
};

fs::path ask_tree(QWidget* window, const QString& title, const fs::path& beside, const QString& suffix)
{
    const fs::path proposal = free_path(beside, suffix.toStdString() + ".pct");
    QString name = QFileDialog::getSaveFileName(window, title, QString::fromStdString(proposal.string()), trees);
    if (!name.isEmpty() && !name.endsWith(".pct")) name += ".pct";
    return name.toStdString();
}

// Nothing where the user has cancelled.
std::optional<TargetChoice> ask_target(QWidget* window, const QString& what, const fs::path& tree,
                                       const QString& suffix)
{
    QMessageBox box(QMessageBox::Question, "Select Points",
                    what +
                        "\n\nInto a copy of the tree, which shares unchanged data with it, or in place? The change "
                        "in place cannot be undone.",
                    QMessageBox::Cancel, window);
    const QPushButton* copy = box.addButton("Into a copy", QMessageBox::AcceptRole);
    const QPushButton* in_place = box.addButton("In place", QMessageBox::DestructiveRole);
    box.setDefaultButton(const_cast<QPushButton*>(copy));
    box.exec();
    if (box.clickedButton() == in_place) return TargetChoice{{}, true};
    if (box.clickedButton() != copy) return std::nullopt;
    const fs::path name = ask_tree(window, "The copy", tree, suffix);
    return name.empty() ? std::nullopt : std::optional(TargetChoice{name, false});
}

void log(Scene& scene, const std::string& line) { scene.log(LogLevel::system, line.c_str()); }

void log_outcome(Scene& scene, const std::vector<std::string>& warnings)
{
    for (const std::string& line : warnings) scene.log(LogLevel::warning, line.c_str());
}

// The tree is written: what fails from here on is only shown.
void show_afterwards(Scene& scene, const fs::path& tree, const std::function<std::vector<std::string>()>& show)
{
    try {
        for (const std::string& line : show()) log(scene, line);
    } catch (...) {
        log_outcome(scene, {"Select Points: the tree " + tree.string() +
                            " was written, but its layer cannot be shown: " + current_error() +
                            " (do not repeat it; open the tree)"});
    }
}

QString extract(SceneView& view, const SceneLayer& layer, const PointSet& set, const fs::path& output, bool is_tree)
{
    ConvertReport report;
    {
        ShownOperation operation(view.window());
        ExtractOptions options;
        options.overwrite = !is_tree;  // the dialog has asked
        options.progress = operation.progress();
        report = extract_points(set, output, options);
    }
    for (const std::string& note : report.notes) log(view.scene(), note);
    log_outcome(view.scene(), report.outcome.warnings);
    if (is_tree) show_afterwards(view.scene(), output, [&] { return add_layer_of(view.scene(), output, &layer); });
    return QString::fromStdString("extracted " + grouped(report.outcome.points_out) + " points to " + output.string() +
                                  (report.points_skipped > 0 ? ", " + grouped(report.points_skipped) +
                                                                   " points were dropped: the format needs finite "
                                                                   "positions"
                                                             : ""));
}

// The class as text; empty: cancelled. QInputDialog completes what the field has, and so changes it on Enter.
QString ask_class(QWidget* window)
{
    QDialog dialog(window);
    dialog.setWindowTitle("Classify selected points");
    auto* choice = new QComboBox(&dialog);
    choice->setObjectName("PointCloudClass");
    choice->setEditable(true);
    choice->setInsertPolicy(QComboBox::NoInsert);
    choice->setCompleter(nullptr);
    for (unsigned number = 0; number < 256; ++number)
        if (const std::string words = las_class_name(number); !words.empty())
            choice->addItem(QString("%1 %2").arg(number).arg(QString::fromStdString(words)));
    choice->setCurrentIndex(choice->findText("2 ", Qt::MatchStartsWith));
    choice->lineEdit()->selectAll();
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel, &dialog);
    QObject::connect(buttons, &QDialogButtonBox::accepted, &dialog, &QDialog::accept);
    QObject::connect(buttons, &QDialogButtonBox::rejected, &dialog, &QDialog::reject);
    auto* rows = new QVBoxLayout(&dialog);
    rows->addWidget(new QLabel("Class of the selected points (0 to 255, names of LAS):", &dialog));
    rows->addWidget(choice);
    rows->addWidget(buttons);
    choice->setFocus();
    return dialog.exec() == QDialog::Accepted ? choice->currentText().trimmed() : QString();
}

// The number that a text begins with: "2", "2 ground". Throws Error(invalid_argument) for another text.
unsigned class_of(const QString& text)
{
    bool good = false;
    const unsigned number = text.section(' ', 0, 0).toUInt(&good);
    if (good && number < 256) return number;
    throw Error(ErrorCode::invalid_argument, {}, "'" + text.toStdString() + "' is not a class",
                "write a number from 0 to 255, or choose one of the list");
}

// "2 (ground)", "77"
QString class_words(unsigned number)
{
    const std::string name = las_class_name(number);
    return QString::number(number) + (name.empty() ? QString() : " (" + QString::fromStdString(name) + ")");
}

QString change(SceneView& view, const PointSet& set, SelectionUse use)
{
    QWidget* const window = view.window();
    const fs::path tree = set.tree().folder();
    const QString count = QString::fromStdString(grouped(set.size()) + " points of " + tree.filename().string());
    QString chosen, question = "Delete " + count + "?", suffix = "-without";
    bool good = true;
    unsigned number = 0;
    if (use == SelectionUse::classify) {
        chosen = ask_class(window);
        if (chosen.isEmpty()) return {};
        number = class_of(chosen);
        question = "Set the class of " + count + " to " + class_words(number) + "?";
        suffix = "-classified";
    } else if (use == SelectionUse::save) {
        chosen =
            QInputDialog::getText(window, "Save the selection",
                                  "Name of the attribute (1: selected, 0: not):", QLineEdit::Normal, "selected", &good)
                .trimmed();
        question = "Save the selection of " + count + " as the attribute '" + chosen + "'?";
        suffix = "-selected";
    }
    if (!good) return {};
    const auto target = ask_target(window, question, tree, suffix);
    if (!target) return {};
    if (target->in_place) refuse_locked(view.scene(), tree);
    fs::path changed;
    QString words;
    {
        ShownOperation operation(view.window());
        SetChangeOptions options;
        options.target = *target;
        options.progress = operation.progress();
        if (use == SelectionUse::remove) {
            const SetErasure done = delete_points(set, options);
            log_outcome(view.scene(), done.report.outcome.warnings);
            changed = done.tree;
            words = QString::fromStdString("deleted " + grouped(done.report.points_deleted) + " points; ");
        } else {
            const SetChangeReport done = use == SelectionUse::save
                                             ? save_as_attribute(set, chosen.toStdString(), options)
                                             : classify_points(set, number, "classification", options);
            log_outcome(view.scene(), done.outcome.warnings);
            changed = done.tree;
            words = use == SelectionUse::save ? "saved " + count + " as the attribute " + chosen + "; "
                                              : "classified " + count + " as " + class_words(number) + "; ";
        }
    }
    show_afterwards(view.scene(), changed, [&] { return show_result(view.scene(), changed, tree); });
    return words + (target->in_place ? "in place" : "into " + QString::fromStdString(changed.string()));
}

LayerCloud tree_to_use(const SceneLayer& layer)
{
    const auto tree = layer.drawn();
    if (!tree)
        throw Error(ErrorCode::invalid_argument, {}, layer.label().toStdString() + " is not shown as a point cloud");
    if (tree->is_copy())
        throw Error(
            ErrorCode::invalid_argument, {},
            layer.label().toStdString() + " is an ordinary layer: what is drawn is a temporary copy of its points",
            "save the layer as a point cloud tree (.pct) and open that");
    return *tree;
}

QString ask_and_extract(SceneView& view, SceneLayer& layer, const PointSet& set, SelectionUse use)
{
    QWidget* const window = view.window();
    if (use == SelectionUse::to_layer) {
        const fs::path output = ask_tree(window, "Extract to a layer", set.tree().folder(), "-part");
        return output.empty() ? QString() : extract(view, layer, set, output, true);
    }
    const QString name = QFileDialog::getSaveFileName(
        window, "Extract to a file", QString::fromStdString((set.tree().folder().parent_path()).string()),
        "Point clouds (*.las *.laz *.ply *.pcd *.e57 *.xyz *.txt *.csv *.pts *.ptx);;All files (*)");
    return name.isEmpty() ? QString() : extract(view, layer, set, name.toStdString(), false);
}

}  // namespace

QString use_selected(SceneView& view, SceneLayer& layer, SelectionUse use)
{
    Operation::refuse_second();
    const auto tree = layer.drawn();
    const auto set = view.scene().part<SceneState>().selection(layer);
    if (!tree || !set)
        throw Error(ErrorCode::invalid_argument, {}, "no point of " + layer.label().toStdString() + " is selected",
                    "select points first");
    tree_to_use(layer);
    if (use != SelectionUse::to_layer && use != SelectionUse::to_file) return change(view, *set, use);
    return ask_and_extract(view, layer, *set, use);
}

QString use_shown(SceneView& view, SceneLayer& layer, SelectionUse use)
{
    Operation::refuse_second();
    const LayerCloud tree = tree_to_use(layer);
    std::optional<PointSet> set;
    {
        ShownOperation operation(view.window());
        SelectOptions options;
        options.progress = operation.progress();
        set = select_points(tree.cloud->tree(), shown_points(view, layer).selection(), options);
    }
    if (set->empty())
        throw Error(ErrorCode::invalid_argument, {}, "no point of " + layer.label().toStdString() + " is shown",
                    "move the clip box, or show hidden classes");
    return ask_and_extract(view, layer, *set, use);
}

}  // namespace pcm::host
