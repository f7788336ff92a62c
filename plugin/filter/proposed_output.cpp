#include "plugin/filter/proposed_output.h"

#include "pcm/system/tree_folder.h"
#include "plugin/filter/filter_paths.h"
#include "plugin/panels/program_form.h"
#include "plugin/scene/free_path.h"

#include <QApplication>
#include <QGridLayout>
#include <QLineEdit>
#include <QPointer>

namespace pcm::host {

namespace {

namespace fs = std::filesystem;

const char* const object_name = "PointCloudProposal";

bool has_window()
{
    for (const QWidget* widget : QApplication::topLevelWidgets())
        if (widget->inherits("MainWindow")) return true;
    return false;
}

bool is_tree_name(const std::string& ending) { return ending.size() > 4 && ending.substr(ending.size() - 4) == ".pct"; }

// The tree that a filter works on, with this text in its field "Tree"; empty: none.
fs::path source_of(const Scene& scene, const QString& named, bool takes_tree)
{
    if (!named.trimmed().isEmpty()) return tree_folder_of(absolute_path(named));
    const auto tree_of = [](const SceneLayer* layer) {
        const auto tree = layer ? layer->tree() : std::nullopt;
        return tree ? tree->cloud->tree()->folder() : fs::path();
    };
    fs::path found = tree_of(scene.current());
    if (takes_tree || !found.empty()) return found;
    for (const SceneLayer* layer : scene.layers())
        if (found.empty() && layer->is_visible()) found = tree_of(layer);
    return found;
}

// What a dialog's field proposes. A child of the field.
class Proposal : public QObject {
public:
    Proposal(QLineEdit& field, QLineEdit* tree, Scene& scene, const std::string& ending, const QString& text)
        : QObject(&field), field_(field), tree_(tree), scene_(&scene), ending_(ending), proposed_(text)
    {
        setObjectName(object_name);
        connect(&scene, &Scene::current_changed, this, [this] { renew(); });
        if (tree) connect(tree, &QLineEdit::textChanged, this, [this] { renew(); });
    }

    void renew()
    {
        if (!scene_ || field_.text() != proposed_) return;  // the user has named it
        const fs::path cloud = source_of(*scene_, tree_ ? tree_->text() : QString(), tree_ != nullptr);
        if (cloud.empty()) return;
        proposed_ = QString::fromStdString(free_path(cloud, ending_).string());
        field_.setText(proposed_);
    }

private:
    QLineEdit& field_;
    const QPointer<QLineEdit> tree_;
    const QPointer<Scene> scene_;
    const std::string ending_;
    QString proposed_;
};

}  // namespace

void propose_output(Parameters& parameters, Scene& scene, const std::string& ending)
{
    const char* const name = is_tree_name(ending) ? "Output" : "OutputFile";
    const Parameter* const output = parameters.find(name);
    if (!has_window() || !output) return;
    const Parameter* const tree = parameters.find("Tree");
    const fs::path cloud = source_of(scene, {}, tree != nullptr);
    const QString text = cloud.empty() ? QString() : QString::fromStdString(free_path(cloud, ending).string());
    when_form_is_shown(scene, [label = output->label, tree_label = tree ? tree->label : QString(), text, ending,
                               &scene](const QGridLayout& rows) {
        QLineEdit* const edit = field_in(rows, label);
        if (edit && edit->text() == text && !edit->findChild<QObject*>(object_name))
            new Proposal(*edit, tree_label.isEmpty() ? nullptr : field_in(rows, tree_label), scene, ending, text);
    });
    parameters.set(name, text);
}

void renew_proposals()
{
    for (QWidget* widget : QApplication::allWidgets())
        if (auto* found = widget->findChild<QObject*>(object_name, Qt::FindDirectChildrenOnly))
            static_cast<Proposal*>(found)->renew();
}

}  // namespace pcm::host
