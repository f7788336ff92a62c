// The forms that the program makes of parameters: a row for each, with a label and a field. They are found by their
// class and changed after they are shown.
#pragma once

#include <QObject>
#include <QString>

#include <functional>

class QGridLayout;
class QLineEdit;

namespace pcm::host {

// Calls `change` for each form that is shown when control is back at the event loop, unless `context` is gone then.
void when_form_is_shown(QObject& context, std::function<void(const QGridLayout& rows)> change);

// The field in the row of this label; null: there is none, or it is not a field of text.
QLineEdit* field_in(const QGridLayout& rows, const QString& label);

}  // namespace pcm::host
