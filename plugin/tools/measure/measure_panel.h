// The panel of the tool Measure: what is measured, the list of measures, and the numbers of one of them. It shows what
// it is given and reports what a user does; the tool decides. GUI thread.
#pragma once

#include "pcm/measure/measure_list.h"
#include "plugin/scene/length_unit.h"

#include <QDockWidget>

#include <map>
#include <optional>
#include <string>
#include <vector>

class QComboBox;
class QGridLayout;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QVBoxLayout;

namespace pcm::host {

class MessageArea;
class NamedList;
class ValueTable;

class MeasurePanel : public QDockWidget {
    Q_OBJECT

public:
    enum class Button { look_at, remove, clear, undo, redo, copy, save, plot, end, cancel, defaults };
    Q_ENUM(Button)

    // A layer whose cloud profiles and volumes may be taken from.
    struct Cloud {
        int layer_id;
        QString label;
    };

    explicit MeasurePanel(QWidget* window);

    MeasureKind kind() const;
    void show_list(const MeasureList& list, std::optional<std::size_t> selected, const std::string& unit);
    void show_unit(const LengthUnit& unit);
    void show_clouds(const std::vector<Cloud>& clouds);
    void show_hint(const QString& text);  // what to do next
    void say(const QString& text);        // what happened
    // While something runs: what it is, and how much of it is done (0 to 1). Nothing: it has ended.
    void show_progress(const std::optional<std::pair<QString, double>>& progress);

    // What is typed; nothing where it is empty. Throws Error(invalid_argument) for text that is not a number above 0 (a
    // level may be any number).
    std::optional<double> width() const;
    std::optional<double> level() const;
    std::optional<double> cell() const;
    void propose_width(const QString& text);  // shown where nothing is typed
    void propose_cell(const QString& text);
    void show_defaults();
    std::optional<int> cloud() const;  // the cloud that is measured; nothing: the one that the points were picked on
    std::optional<int> compared_cloud() const;  // for a volume; nothing: a level

signals:
    void kind_chosen();
    void unit_chosen(const QString& symbol);
    void pressed(MeasurePanel::Button button);
    void renamed(int index, const QString& name);
    void hidden(int index, bool hidden);
    void selected(int index);  // -1: none

private:
    QPushButton* add_button(QGridLayout& rows, int row, int column, Button button, const char* text,
                            const char* tooltip, int span = 2);
    QLineEdit* add_field(QGridLayout& rows, const char* name, const char* label, const char* tooltip);
    QComboBox* add_choice(QGridLayout& rows, const char* name, const char* label, const char* tooltip);
    void add_fields(QVBoxLayout& column);
    void add_list(QVBoxLayout& column);
    void show_fields();
    void show_values(const Measure* measure, const std::string& unit);

    QComboBox *kind_ = nullptr, *cloud_ = nullptr, *compared_ = nullptr, *unit_ = nullptr;
    QLineEdit *width_ = nullptr, *level_ = nullptr, *cell_ = nullptr;
    NamedList* list_ = nullptr;
    ValueTable* values_ = nullptr;
    MessageArea *hint_ = nullptr, *words_ = nullptr;
    QProgressBar* progress_ = nullptr;
    QWidget* fields_ = nullptr;
    std::map<Button, QPushButton*> buttons_;
    std::map<QWidget*, std::vector<QWidget*>> rows_;  // widgets of each field, its label included
};

}  // namespace pcm::host
