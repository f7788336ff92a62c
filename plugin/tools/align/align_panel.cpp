#include "plugin/tools/align/align_panel.h"

#include "pcm/system/text.h"
#include "plugin/panels/message_area.h"
#include "plugin/panels/tool_dock.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/layer_visibility.h"
#include "plugin/scene/text.h"
#include "plugin/tools/align/write_moved.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFileDialog>
#include <QGridLayout>
#include <QHeaderView>
#include <QLabel>
#include <QMainWindow>
#include <QPushButton>
#include <QTableWidget>

#include <utility>

namespace pcm::host {

namespace {

const char* const object_name = "PointCloudAlignDock";
constexpr int message_lines = 4, summary_lines = 7;
const char* const pair_files = "Pairs of points (*.txt);;All files (*)";

QTableWidgetItem* cell_of(const std::optional<PickedEnd>& end)
{
    if (!end) return new QTableWidgetItem("pick it in the view");
    auto* cell = new QTableWidgetItem(QString::fromStdString(exact(end->position)));
    cell->setToolTip(cell->text());  // where the column is too narrow
    return cell;
}

}  // namespace

AlignPanel& AlignPanel::of(const SceneView& view)
{
    QMainWindow* const window = view.window();
    auto* found = window->findChild<AlignPanel*>(object_name);
    return found ? *found : *new AlignPanel(window);
}

AlignPanel::AlignPanel(QWidget* window) : QDockWidget("Align by Picked Pairs", window)
{
    setObjectName(object_name);
    auto* form = new QWidget;
    auto* rows = new QGridLayout(form);
    add_layers(*rows);
    add_pairs(*rows);
    add_result(*rows);
    fill_dock(*this, form);
    refresh();
}

QPushButton* AlignPanel::add_button(QGridLayout& rows, int row, int column, const char* text, const char* tooltip,
                                    void (AlignPanel::*pressed)())
{
    auto* button = new QPushButton(text);
    button->setToolTip(tooltip);
    rows.addWidget(button, row, column);
    connect(button, &QPushButton::clicked, this, [this, pressed] { guarded([this, pressed] { (this->*pressed)(); }); });
    return button;
}

void AlignPanel::add_layers(QGridLayout& rows)
{
    const auto add = [&](QComboBox*& box, const char* name, const char* tooltip) {
        const int row = rows.rowCount();
        box = new QComboBox;
        box->setToolTip(tooltip);
        box->setObjectName(QString("PointCloudAlign") + name);
        box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        auto* label = new QLabel(QString(name) + " layer");
        label->setToolTip(tooltip);
        rows.addWidget(label, row, 0);
        rows.addWidget(box, row, 1, 1, 2);
        connect(box, QOverload<int>::of(&QComboBox::activated), this, &AlignPanel::choose);
    };
    add(moving_, "Moving", "The layer that is moved to the other one. At first: the current layer.");
    add(fixed_, "Fixed", "The layer that stays where it is. At first: the first other visible layer.");
    const int row = rows.rowCount();
    add_button(rows, row, 0, "Swap Layers", "The layers exchange their roles; the pairs stay.", &AlignPanel::swap);
    shown_ = new QComboBox;
    shown_->addItems({"Show both", "Show the moving layer", "Show the fixed layer"});
    shown_->setToolTip(
        "Which of the two layers the views show: to pick in one where the other hides it. Default both.");
    rows.addWidget(shown_, row, 1, 1, 2);
    connect(shown_, QOverload<int>::of(&QComboBox::activated), this, &AlignPanel::show_only);
}

void AlignPanel::add_pairs(QGridLayout& rows)
{
    message_ = new MessageArea("PointCloudAlignMessage", message_lines);
    message_->say(
        "Click on a point of the moving layer, then on the same place in the fixed one: three pairs or "
        "more, far apart. Dragging turns the view.");
    rows.addWidget(message_, rows.rowCount(), 0, 1, 3);
    table_ = new QTableWidget(0, 3);
    table_->setObjectName("PointCloudAlignPairs");
    table_->setHorizontalHeaderLabels({"Residual", "Moving point", "Fixed point"});
    table_->setToolTip(
        "The pairs in source coordinates, and how far apart each is after the motion, source units. The "
        "points of a chosen row are replaced by the next picks.");
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->setSelectionMode(QAbstractItemView::SingleSelection);
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    rows.addWidget(table_, rows.rowCount(), 0, 1, 3);
    connect(table_, &QTableWidget::itemSelectionChanged, this, [this] {
        if (filling_ || !session_) return;
        const auto chosen = table_->selectionModel()->selectedRows();
        session_->select(chosen.empty() ? -1 : chosen.first().row());
    });
    const int row = rows.rowCount();
    add_button(rows, row, 0, "Delete Pair", "Deletes the chosen pair, or the last one. Key: Delete.",
               &AlignPanel::remove_pair);
    add_button(rows, row, 1, "Clear Pairs", "Deletes all pairs.", &AlignPanel::clear);
    scale_ = new QCheckBox("Fit a scale");
    scale_->setToolTip(
        "Fits one scale in addition to rotation and translation: for clouds in different units. Default off.");
    connect(scale_, &QCheckBox::toggled, this, [this](bool on) {
        if (session_ && !filling_) session_->set_scale(on);
    });
    rows.addWidget(scale_, row, 2);
    add_button(rows, row + 1, 0, "Load Pairs...",
               "Replaces the pairs by those of a text file: x y z x y z a line, source coordinates of the two clouds.",
               &AlignPanel::load);
    add_button(rows, row + 1, 1, "Save Pairs...", "Writes the complete pairs to a text file, with all digits.",
               &AlignPanel::save);
}

void AlignPanel::add_result(QGridLayout& rows)
{
    summary_ = new MessageArea("PointCloudAlignSummary", summary_lines);
    int row = rows.rowCount();
    rows.addWidget(summary_, row++, 0, 1, 3);
    apply_ = add_button(rows, row, 0, "Apply Alignment",
                        "Sets the moving layer's matrix, which the views show at once. MeshLab keeps it in single "
                        "precision.",
                        &AlignPanel::apply);
    undo_ = add_button(rows, row, 1, "Undo Alignment",
                       "Gives the moving layer the matrix that it had before. Ctrl+Z in the view.", &AlignPanel::undo);
    redo_ = add_button(rows, row, 2, "Redo Alignment", "Repeats what was undone.", &AlignPanel::redo);
    write_ = add_button(rows, ++row, 0, "Write Moved Tree...",
                        "Writes the moving layer's tree, moved in double, as a new tree, and shows that instead. Esc "
                        "cancels it.",
                        &AlignPanel::write_moved);
    rows.setRowStretch(row + 1, 1);
}

void AlignPanel::show_session(AlignSession* session)
{
    if (session_ == session) return refresh();
    if (session_) session_->disconnect(this);
    session_ = session;
    if (session) {
        connect(session, &AlignSession::changed, this, &AlignPanel::refresh);
        connect(session, &QObject::destroyed, this, &AlignPanel::refresh);
    }
    refresh();
}

void AlignPanel::say(const QString& text) { message_->say(text); }

void AlignPanel::step(bool again)
{
    guarded([this, again] { again ? redo() : undo(); });
}

void AlignPanel::guarded(const std::function<void()>& work)
{
    if (!session_) return;
    try {
        work();
    } catch (...) {
        const std::string error = current_error();
        say(QString::fromStdString(error));
        if (session_) session_->scene().log(LogLevel::warning, ("Align by Picked Pairs: " + error).c_str());
    }
    refresh();
}

void AlignPanel::fill_layers()
{
    for (const auto& [box, chosen] : {std::pair(moving_, session_->moving()), std::pair(fixed_, session_->fixed())}) {
        box->clear();
        for (const SceneLayer* layer : session_->scene().layers())
            if (layer->drawn()) box->addItem(layer->label(), layer->id());
        box->setCurrentIndex(chosen ? box->findData(chosen->id()) : -1);
    }
}

void AlignPanel::fill_table()
{
    const auto& pairs = session_->pairs();
    table_->setRowCount(int(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const int row = int(i), number = session_->number_in_fit(i);
        const QString residual = session_->fit() && number >= 0
                                     ? QString::fromStdString(brief(session_->fit()->residuals[std::size_t(number)]))
                                     : QString("-");
        table_->setItem(row, 0, new QTableWidgetItem(residual));
        table_->setItem(row, 1, cell_of(pairs[i].moving));
        table_->setItem(row, 2, cell_of(pairs[i].fixed));
    }
    if (session_->selected() >= 0)
        table_->selectRow(session_->selected());
    else
        table_->clearSelection();
}

void AlignPanel::refresh()
{
    setEnabled(session_ != nullptr);
    if (!session_ || filling_) return;
    filling_ = true;
    fill_layers();
    fill_table();
    scale_->setChecked(session_->with_scale());
    summary_->say(summary_of(*session_));
    const SceneLayer* moving = session_->moving();
    const LayerMatrices& matrices = session_->scene().part<LayerMatrices>();
    apply_->setEnabled(session_->fit().has_value());
    write_->setEnabled(session_->fit().has_value());
    undo_->setEnabled(moving && !matrices.undo_words(*moving).isEmpty());
    redo_->setEnabled(moving && !matrices.redo_words(*moving).isEmpty());
    filling_ = false;
}

void AlignPanel::choose()
{
    if (session_ && !filling_) session_->choose(moving_->currentData().toInt(), fixed_->currentData().toInt());
}

void AlignPanel::show_only()
{
    if (!session_) return;
    if (session_->moving()) session_->moving()->show(shown_->currentIndex() != 2);
    if (session_->fixed()) session_->fixed()->show(shown_->currentIndex() != 1);
    session_->scene().refresh_layer_lists();
}

void AlignPanel::swap() { session_->swap(); }

void AlignPanel::remove_pair()
{
    session_->remove(session_->selected() >= 0 ? session_->selected() : int(session_->pairs().size()) - 1);
}

void AlignPanel::clear() { session_->clear(); }

void AlignPanel::load()
{
    const QString file = QFileDialog::getOpenFileName(this, "Load pairs of points", QString(), pair_files);
    if (!file.isEmpty() && session_) session_->load(file.toStdString());
}

void AlignPanel::save()
{
    const QString file = QFileDialog::getSaveFileName(this, "Save pairs of points", "pairs.txt", pair_files);
    if (!file.isEmpty() && session_) session_->save(file.toStdString());
}

void AlignPanel::apply()
{
    for (const std::string& line : session_->apply()) session_->scene().log(LogLevel::filter, line.c_str());
    say("The moving layer's matrix is set.");
}

void AlignPanel::undo()
{
    if (session_->moving()) session_->scene().part<LayerMatrices>().undo(*session_->moving());
}

void AlignPanel::redo()
{
    if (session_->moving()) session_->scene().part<LayerMatrices>().redo(*session_->moving());
}

void AlignPanel::write_moved()
{
    if (!session_->fit()) throw Error(ErrorCode::invalid_argument, {}, session_->problem().toStdString());
    const QString file =
        QFileDialog::getSaveFileName(this, "Name the moved tree", proposed_tree(*session_), "Point cloud tree (*.pct)",
                                     nullptr, QFileDialog::DontConfirmOverwrite);
    if (file.isEmpty() || !session_) return;
    const QPointer<AlignPanel> alive(this);
    write_moved_layer(*session_, file, [alive](const QString& text) {
        if (alive) alive->say(text);
    });
}

}  // namespace pcm::host
