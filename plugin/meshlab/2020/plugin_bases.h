// What the plugins derive from, over MeshLab 2020.09: functions have the names of newer generations, and failures are
// exceptions.
#pragma once

#include "plugin/meshlab/2020/seams.h"

#include <Eigen/Core>

#include <QVariant>

#include <map>
#include <string>

// For Q_INTERFACES and Q_PLUGIN_METADATA.
#define PCM_IO_INTERFACE MeshIOInterface
#define PCM_IO_IID MESH_IO_INTERFACE_IID
#define PCM_FILTER_INTERFACE MeshFilterInterface
#define PCM_FILTER_IID MESH_FILTER_INTERFACE_IID
#define PCM_DECORATE_INTERFACE MeshDecorateInterface
#define PCM_DECORATE_IID MESH_DECORATE_INTERFACE_IID
#define PCM_EDIT_INTERFACE MeshEditInterfaceFactory
#define PCM_EDIT_IID MESH_EDIT_INTERFACE_FACTORY_IID

Q_DECLARE_METATYPE(Eigen::VectorXd)  // newer ones have it

namespace pcm::host {

// What a user reads about a failure; MLException alone holds it in the encoding of the system.
class Failure : public MLException {
public:
    explicit Failure(const QString& message) : MLException(message), text(message) {}
    const QString text;
};

class IoBase : public MeshIOInterface {
public:
    virtual FormatList all_import_formats() const = 0;
    // Settings in Tools > Options.
    virtual void add_global_parameters(RichParameterList& parameters) = 0;
    virtual RichParameterList parameters_before_open(const QString& format, const QString& file_name) const = 0;
    virtual void opened(MeshModel& layer) = 0;
    virtual RichParameterList save_parameters(const QString& format, const MeshModel& layer) const = 0;
    virtual void exportMaskCapability(const QString& format, int& capability, int& defaults) const = 0;
    // Both throw Failure.
    virtual void open_layer(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                            const RichParameterList& parameters, vcg::CallBackPos* callback) = 0;
    virtual void save_layer(const QString& format, const QString& file_name, MeshModel& layer, int mask,
                            const RichParameterList& parameters, vcg::CallBackPos* callback) = 0;

    FormatList importFormats() const final { return all_import_formats(); }
    void initGlobalParameterSet(QAction*, RichParameterList& parameters) final;
    void initPreOpenParameter(const QString& format, const QString& file_name, RichParameterList& parameters) final;
    void initOpenParameter(const QString&, MeshModel& layer, RichParameterList&) final { opened(layer); }
    void initSaveParameter(const QString& format, MeshModel& layer, RichParameterList& parameters) final;
    void GetExportMaskCapability(QString& format, int& capability, int& defaults) const final;
    bool open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget*) final;
    bool save(const QString& format, const QString& file_name, MeshModel& layer, const int mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget*) final;

protected:
    // Writes to the log; without a window also to standard output: meshlabserver does not print the log of imports.
    void say(GLLogStream::Levels level, const std::string& line, bool has_window);
    // Shown after success.
    void warn_after(const QString& text) { errorMessage = text; }
};

class FilterBase : public MeshFilterInterface {
public:
    using Values = std::map<std::string, QVariant>;

    virtual QString name_of(int filter) const = 0;
    virtual QString info_of(int filter) const = 0;
    virtual int classes_of(PluginAction* action) const = 0;
    virtual RichParameterList parameters_for(PluginAction* action, const MeshDocument& document) = 0;
    // The numbers that a filter returns, which this MeshLab has no use for. Throws Failure.
    virtual Values run(PluginAction* action, MeshDocument& document, const RichParameterList& parameters,
                       vcg::CallBackPos* callback) = 0;

    QString filterName(FilterIDType filter) const final { return name_of(filter); }
    QString filterInfo(FilterIDType filter) const final { return info_of(filter); }
    FilterClass getClass(QAction* action) final { return FilterClass(classes_of(action)); }
    FILTER_ARITY filterArity(QAction*) const final { return NONE; }
    int getPreConditions(QAction*) const final { return MeshModel::MM_NONE; }
    // The overload with a document: MeshLab calls the other one with a null reference when there is no layer.
    void initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters) final;
    bool applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                     vcg::CallBackPos* callback) final;

protected:
    void say(GLLogStream::Levels level, const std::string& line) { Log(level, line); }
};

class DecorateBase : public MeshDecorateInterface {
public:
    virtual void initGlobalParameterList(PluginAction* action, RichParameterList& parameters) = 0;
    void initGlobalParameterSet(QAction* action, RichParameterList& parameters) final
    {
        initGlobalParameterList(action, parameters);
    }
};

class EditToolBase : public MeshEditInterface {
public:
    virtual bool startEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) = 0;
    virtual void endEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) = 0;
    virtual void layerChanged(MeshDocument&, MeshModel&, GLArea*, MLSceneGLSharedDataContext*) = 0;
    virtual void decorate(MeshModel& layer, GLArea* area, QPainter* painter) = 0;

    QString pluginName() const final { return "EditPointCloud"; }
    bool StartEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) final
    {
        return startEdit(document, area, shared);
    }
    void EndEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) final
    {
        endEdit(document, area, shared);
    }
    void LayerChanged(MeshDocument& document, MeshModel& layer, GLArea* area, MLSceneGLSharedDataContext* shared) final
    {
        layerChanged(document, layer, area, shared);
    }
    void Decorate(MeshModel& layer, GLArea* area, QPainter* painter) final { decorate(layer, area, painter); }
};

class EditBase : public MeshEditInterfaceFactory {
public:
    virtual QString pluginName() const = 0;
    virtual MeshEditInterface* getEditTool(PluginAction* action) = 0;
    MeshEditInterface* getMeshEditInterface(QAction* action) final { return getEditTool(action); }
};

}  // namespace pcm::host
