#include "plugin/panels/program_form.h"

#include <QApplication>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QTimer>

#include <utility>

namespace pcm::host {

void when_form_is_shown(QObject& context, std::function<void(const QGridLayout& rows)> change)
{
    QTimer::singleShot(0, &context, [change = std::move(change)] {
        for (const QWidget* widget : QApplication::allWidgets())
            if (widget->inherits("RichParameterListFrame") && widget->isVisible())
                if (const auto* rows = qobject_cast<QGridLayout*>(widget->layout())) change(*rows);
    });
}

QLineEdit* field_in(const QGridLayout& rows, const QString& label)
{
    for (int row = 0; row < rows.rowCount(); ++row) {
        const auto widget_at = [&](int column) {
            QLayoutItem* item = rows.itemAtPosition(row, column);
            return item ? item->widget() : nullptr;
        };
        const auto* found = qobject_cast<QLabel*>(widget_at(0));
        if (found && found->text() == label) return qobject_cast<QLineEdit*>(widget_at(1));
    }
    return nullptr;
}

}  // namespace pcm::host
