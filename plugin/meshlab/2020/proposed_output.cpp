#include "plugin/meshlab/2020/proposed_output.h"

#include "pcm/system/tree_folder.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/scene/free_path.h"

#include <QApplication>
#include <QDir>
#include <QFileInfo>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QRegularExpression>
#include <QTimer>

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
fs::path source_of(MeshDocument& document, const QString& named, bool takes_tree)
{
    if (!named.trimmed().isEmpty())
        return tree_folder_of(QDir::cleanPath(QFileInfo(named.trimmed()).absoluteFilePath()).toStdString());
    const auto tree_of = [](const MeshModel* layer) {
        const auto tree = layer ? Registry::instance().find(*layer) : std::nullopt;
        return tree ? tree->cloud->tree()->folder() : fs::path();
    };
    fs::path found = tree_of(document.mm());
    if (takes_tree || !found.empty()) return found;
    for (const MeshModel* layer : document.meshList)
        if (found.empty() && layer && layer->visible) found = tree_of(layer);
    return found;
}

// The rows of MeshLab's frame of parameters: a label with its description, and the field.
QLineEdit* field_in(const QGridLayout& rows, const QString& description)
{
    for (int row = 0; row < rows.rowCount(); ++row) {
        const auto widget_at = [&](int column) {
            QLayoutItem* item = rows.itemAtPosition(row, column);
            return item ? item->widget() : nullptr;
        };
        const auto* label = qobject_cast<QLabel*>(widget_at(0));
        if (label && label->text() == description) return qobject_cast<QLineEdit*>(widget_at(1));
    }
    return nullptr;
}

// What a dialog's field proposes. A child of the field.
class Proposal : public QObject {
public:
    Proposal(QLineEdit& field, QLineEdit* tree, MeshDocument& document, const std::string& ending, const QString& text)
        : QObject(&field), field_(field), tree_(tree), document_(&document), ending_(ending), proposed_(text)
    {
        setObjectName(object_name);
        connect(&document, &MeshDocument::currentMeshChanged, this, [this] { renew(); });
        if (tree) connect(tree, &QLineEdit::textChanged, this, [this] { renew(); });
    }

    void renew()
    {
        if (!document_ || field_.text() != proposed_) return;  // the user has named it
        const fs::path cloud = source_of(*document_, tree_ ? tree_->text() : QString(), tree_ != nullptr);
        if (cloud.empty()) return;
        proposed_ = QString::fromStdString(free_path(cloud, ending_).string());
        field_.setText(proposed_);
    }

private:
    QLineEdit& field_;
    const QPointer<QLineEdit> tree_;
    const QPointer<MeshDocument> document_;
    const std::string ending_;
    QString proposed_;
};

}  // namespace

void propose_output(RichParameterList& parameters, MeshDocument& document, const std::string& ending)
{
    const char* const name = is_tree_name(ending) ? "Output" : "OutputFile";
    if (!has_window() || !parameters.hasParameter(name)) return;
    const bool takes_tree = parameters.hasParameter("Tree");
    const fs::path cloud = source_of(document, {}, takes_tree);
    const QString text = cloud.empty() ? QString() : QString::fromStdString(free_path(cloud, ending).string());
    parameters.setValue(name, StringValue(text));
    const QString field = parameters.getParameterByName(name).fieldDescription();
    const QString tree = takes_tree ? parameters.getParameterByName("Tree").fieldDescription() : QString();
    // MeshLab shows the dialog afterwards.
    QTimer::singleShot(0, &document, [field, tree, text, ending, alive = QPointer<MeshDocument>(&document)] {
        for (QWidget* widget : QApplication::allWidgets()) {
            if (!alive || !widget->inherits("RichParameterListFrame") || !widget->isVisible()) continue;
            const auto* rows = qobject_cast<QGridLayout*>(widget->layout());
            QLineEdit* const edit = rows ? field_in(*rows, field) : nullptr;
            if (edit && edit->text() == text && !edit->findChild<QObject*>(object_name))
                new Proposal(*edit, tree.isEmpty() ? nullptr : field_in(*rows, tree), *alive, ending, text);
        }
    });
}

void renew_proposals()
{
    for (QWidget* widget : QApplication::allWidgets())
        if (auto* found = widget->findChild<QObject*>(object_name, Qt::FindDirectChildrenOnly))
            static_cast<Proposal*>(found)->renew();
}

}  // namespace pcm::host
