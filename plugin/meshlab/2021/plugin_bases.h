// What the plugins derive from, over MeshLab since 2021.05.
#pragma once

#include "plugin/meshlab/2021/seams.h"

#include <QVariant>

#include <map>
#include <string>

// For Q_INTERFACES and Q_PLUGIN_METADATA.
#define PCM_IO_INTERFACE IOPlugin
#define PCM_IO_IID IO_PLUGIN_IID
#define PCM_FILTER_INTERFACE FilterPlugin
#define PCM_FILTER_IID FILTER_PLUGIN_IID
#define PCM_DECORATE_INTERFACE DecoratePlugin
#define PCM_DECORATE_IID DECORATE_PLUGIN_IID
#define PCM_EDIT_INTERFACE EditPlugin
#define PCM_EDIT_IID EDIT_PLUGIN_IID

namespace pcm::host {

inline QString our_vendor() { return "PCM for MeshLab"; }

// The settings of MeshLab's window; null: there is none.
RichParameterList* window_settings();

// What a user reads about a failure.
class Failure : public MLException {
public:
    explicit Failure(const QString& message) : MLException(message), text(message) {}
    const QString text;
};

class IoBase : public IOPlugin {
public:
    virtual FormatList all_import_formats() const = 0;
    virtual void add_global_parameters(RichParameterList& parameters) = 0;
    virtual RichParameterList parameters_before_open(const QString& format, const QString& file_name) const = 0;
    virtual void opened(MeshModel& layer) = 0;
    virtual RichParameterList save_parameters(const QString& format, const MeshModel& layer) const = 0;
    // Both throw Failure.
    virtual void open_layer(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                            const RichParameterList& parameters, vcg::CallBackPos* callback) = 0;
    virtual void save_layer(const QString& format, const QString& file_name, MeshModel& layer, int mask,
                            const RichParameterList& parameters, vcg::CallBackPos* callback) = 0;

    QString vendor() const final { return our_vendor(); }
    // All when MeshLab lists the plugin, and it gives extensions away; afterwards those that no other plugin reads.
    // MeshLab makes settings for each extension of each plugin, and asserts that their names differ.
    FormatList importFormats() const final;
    // Called before MeshLab changes the working folder, to which it returns after success only.
    unsigned int numberMeshesContainedInFile(const QString&, const QString&, const RichParameterList&) const final;
    RichParameterList initPreOpenParameter(const QString& format) const final;
    using IOPlugin::open;  // the overload for several layers
    void open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback) final;
    RichParameterList initSaveParameter(const QString& format, const MeshModel& layer) const final
    {
        return save_parameters(format, layer);
    }
    void save(const QString& format, const QString& file_name, MeshModel& layer, const int mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback) final
    {
        save_layer(format, file_name, layer, mask, parameters, callback);
    }
    // The last that MeshLab asks an importer for when it lists it.
    FormatList exportProjectFormats() const final;

protected:
    // Called once, when MeshLab has listed the plugin.
    virtual void was_listed() const {}
    // Writes to the log. Nothing is printed: this is a library for Python, too.
    void say(GLLogStream::Levels level, const std::string& line, bool) { log(level, line); }
    void warn_after(const QString& text) { reportWarning(text); }

private:
    void list_first() const;

    mutable QString folder_;           // the working folder before an import
    mutable bool is_listed_ = false;   // MeshLab has listed it, or does
    mutable bool is_settled_ = false;  // after that
};

class FilterBase : public FilterPlugin {
public:
    using Values = std::map<std::string, QVariant>;

    virtual QString name_of(int filter) const = 0;
    virtual QString info_of(int filter) const = 0;
    virtual int classes_of(PluginAction* action) const = 0;
    virtual RichParameterList parameters_for(PluginAction* action, const MeshDocument& document) = 0;
    // Returns the numbers for Python's dict. Throws Failure.
    virtual Values run(PluginAction* action, MeshDocument& document, const RichParameterList& parameters,
                       vcg::CallBackPos* callback) = 0;

    QString vendor() const final { return our_vendor(); }
    using FilterPlugin::filterInfo;
    using FilterPlugin::filterName;
    QString filterName(ActionIDType filter) const final { return name_of(filter); }
    QString filterInfo(ActionIDType filter) const final { return info_of(filter); }
    FilterClass getClass(const QAction* action) const final { return FilterClass(classes_of(action)); }
    FilterArity filterArity(const QAction*) const final { return NONE; }
    RichParameterList initParameterList(const QAction* action, const MeshDocument& document) final
    {
        meet(const_cast<MeshDocument&>(document));
        return parameters_for(action, document);
    }
    Values applyFilter(const QAction* action, const RichParameterList& parameters, MeshDocument& document,
                       unsigned int& post_conditions, vcg::CallBackPos* callback) final
    {
        meet(document);
        post_conditions = MeshModel::MM_NONE;
        return run(action, document, parameters, callback);
    }

protected:
    void say(GLLogStream::Levels level, const std::string& line) { log(level, line); }
};

class DecorateBase : public DecoratePlugin {
public:
    QString vendor() const final { return our_vendor(); }
};

class EditToolBase : public ::EditTool {};

class EditBase : public EditPlugin {
public:
    QString vendor() const final { return our_vendor(); }
};

}  // namespace pcm::host
