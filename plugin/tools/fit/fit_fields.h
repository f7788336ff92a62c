// The fields of the panel Fit Primitives that say how shapes are fitted. GUI thread.
#pragma once

#include "plugin/tools/fit/fit_settings.h"

#include <QWidget>

#include <vector>

class QCheckBox;
class QComboBox;
class QGridLayout;
class QLineEdit;
class QToolButton;

namespace pcm::host {

class FitFields : public QWidget {
    Q_OBJECT

public:
    FitFields();  // with what the user's settings have kept

    FitSettings settings() const;
    void show_defaults();  // counts as a change by the user

signals:
    void changed();  // the user has changed a field; the settings are kept already

private:
    void add(const ops::Argument& argument, QWidget* field, bool is_basic = true);
    // A field for an argument that is a choice, with its names as data.
    QComboBox* add_choice(const char* name, const char* argument, bool is_basic = true);
    void add_choices();
    void add_number(const FitNumber& row);
    void show(const FitSettings& settings);
    void show_more(bool on);
    void report();

    QGridLayout* rows_ = nullptr;
    QComboBox *kind_ = nullptr, *estimator_ = nullptr, *outline_ = nullptr, *backend_ = nullptr, *size_ = nullptr;
    QCheckBox* grow_ = nullptr;
    QToolButton* more_ = nullptr;
    std::vector<QLineEdit*> numbers_;  // as fit_numbers()
    std::vector<QWidget*> advanced_;   // fields and labels that are shown on request
    bool showing_ = true;              // what is shown is not typed
};

}  // namespace pcm::host
