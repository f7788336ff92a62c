// The panel of the tool Align by Picked Pairs: layers, pairs with their residuals, the motion, and what is done with
// it.
#pragma once

#include "plugin/scene/scene_view.h"

#include "plugin/tools/align/align_session.h"

#include <QDockWidget>
#include <QPointer>

#include <functional>

class QCheckBox;
class QComboBox;
class QGridLayout;
class QPushButton;
class QTableWidget;

namespace pcm::host {

class MessageArea;

// One for each window. GUI thread.
class AlignPanel : public QDockWidget {
    Q_OBJECT

public:
    static AlignPanel& of(const SceneView& view);

    // Shows this session until another one is shown; null: none.
    void show_session(AlignSession* session);
    // One line about the last pick, or what went wrong.
    void say(const QString& text);
    // Undoes the last change of the moving layer's matrix, or repeats it.
    void step(bool again);

private:
    explicit AlignPanel(QWidget* window);
    void add_layers(QGridLayout& rows);
    void add_pairs(QGridLayout& rows);
    void add_result(QGridLayout& rows);
    QPushButton* add_button(QGridLayout& rows, int row, int column, const char* text, const char* tooltip,
                            void (AlignPanel::*pressed)());
    void refresh();
    void fill_layers();
    void fill_table();
    void choose();
    void show_only();
    // Runs `work`; what it throws is shown in the panel.
    void guarded(const std::function<void()>& work);

    void swap();
    void remove_pair();
    void clear();
    void load();
    void save();
    void apply();
    void undo();
    void redo();
    void write_moved();

    QPointer<AlignSession> session_;
    QComboBox *moving_ = nullptr, *fixed_ = nullptr, *shown_ = nullptr;
    QTableWidget* table_ = nullptr;
    QCheckBox* scale_ = nullptr;
    MessageArea *message_ = nullptr, *summary_ = nullptr;
    QPushButton *apply_ = nullptr, *undo_ = nullptr, *redo_ = nullptr, *write_ = nullptr;
    bool filling_ = false;
};

}  // namespace pcm::host
