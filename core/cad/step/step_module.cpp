// The shared object with OpenCASCADE in it: see step_module.h. Shapes become the solids and faces of an AP214 file.
#include "pcm/cad/step/step_module.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <Standard_Failure.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>

#include <cstring>
#include <ostream>
#include <streambuf>
#include <string>

namespace pcm {
namespace {

// Called for each piece of what OpenCASCADE prints to a stream.
class Pieces : public std::streambuf {
public:
    Pieces(bool (*append)(void* to, const char* bytes, std::size_t size), void* to) : append_(append), to_(to) {}

private:
    std::streamsize xsputn(const char* bytes, std::streamsize size) override
    {
        return append_(to_, bytes, static_cast<std::size_t>(size)) ? size : 0;
    }
    int_type overflow(int_type c) override
    {
        const char byte = traits_type::to_char_type(c);
        return append_(to_, &byte, 1) ? c : traits_type::eof();
    }

    bool (*append_)(void* to, const char* bytes, std::size_t size);
    void* to_;
};

gp_Pnt point(const double (&v)[3]) { return {v[0], v[1], v[2]}; }
gp_Dir direction(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

TopoDS_Shape face(const StepShape& shape)
{
    const gp_Pln plane(point(shape.place), direction(shape.axis));
    BRepBuilderAPI_MakePolygon polygon;
    for (std::size_t i = 0; i < shape.corner_count; ++i) {
        gp_Pnt corner = point(shape.corners[i]);
        const gp_Vec normal(plane.Axis().Direction());
        corner.Translate(-gp_Vec(plane.Location(), corner).Dot(normal) * normal);  // fits are not exactly flat
        polygon.Add(corner);
    }
    polygon.Close();
    return BRepBuilderAPI_MakeFace(plane, polygon.Wire(), true).Face();
}

TopoDS_Shape solid(const StepShape& shape)
{
    if (shape.form == StepShape::Form::face) return face(shape);
    const gp_Ax2 axes(point(shape.place), direction(shape.axis), direction(shape.zero));
    switch (shape.form) {
        case StepShape::Form::frustum:
            if (shape.radius == shape.second) return BRepPrimAPI_MakeCylinder(axes, shape.radius, shape.length).Solid();
            return BRepPrimAPI_MakeCone(axes, shape.radius, shape.second, shape.length).Solid();
        case StepShape::Form::ball:
            return BRepPrimAPI_MakeSphere(axes, shape.radius).Solid();
        case StepShape::Form::ring:
            return BRepPrimAPI_MakeTorus(axes, shape.radius, shape.second, shape.arc).Solid();
        case StepShape::Form::face:
            break;
    }
    return {};
}

// A document with all shapes, their names and colours. `made`: how many there are, also where this throws.
Handle(TDocStd_Document) document_of(const StepShape* shapes, std::size_t count, std::size_t& made)
{
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    const Handle(XCAFDoc_ShapeTool) tree = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
    for (made = 0; made < count; ++made) {
        const StepShape& shape = shapes[made];
        const TopoDS_Shape body = solid(shape);
        if (body.IsNull() || !BRepCheck_Analyzer(body).IsValid())
            throw Standard_Failure(shape.form == StepShape::Form::face ? "its outline crosses itself or has no area"
                                                                       : "its surface is not closed");
        const TDF_Label label = tree->AddShape(body, false);
        TDataStd_Name::Set(label, TCollection_ExtendedString(shape.name, true));
        const Quantity_Color colour(shape.colour[0], shape.colour[1], shape.colour[2], Quantity_TOC_sRGB);
        colours->SetColor(label, colour, XCAFDoc_ColorSurf);
    }
    return document;
}

void set_header(const Handle(StepData_StepModel) & model, const char* title)
{
    APIHeaderSection_MakeHeader header(model);
    header.SetName(new TCollection_HAsciiString(title));
    header.SetOriginatingSystem(new TCollection_HAsciiString("PCM for MeshLab"));
}

bool fail(const char* why, char* message)
{
    std::strncpy(message, why, step_message_bytes - 1);
    message[step_message_bytes - 1] = 0;
    return false;
}

bool write(const StepShape* shapes, std::size_t count, const char* title, const StepUnit* unit,
           bool (*append)(void* to, const char* bytes, std::size_t size), void* to, std::size_t* shape, char* message)
{
    *shape = count;
    std::size_t made = 0;
    Handle(TDocStd_Document) document;
    try {
        Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
        STEPControl_Controller::Init();  // defines the settings, which a writer reads when it is made
        Interface_Static::SetCVal("write.step.schema", "AP214IS");
        Interface_Static::SetCVal("write.step.unit", unit->name);
        STEPCAFControl_Writer writer;
        document = document_of(shapes, count, made);
        XCAFDoc_DocumentTool::SetLengthUnit(document, unit->millimetres, UnitsMethods_LengthUnit_Millimeter);
        writer.SetColorMode(true);
        writer.SetNameMode(true);
        // OpenCASCADE 7.8 takes the unit's name from the setting, but not its size: coordinates would be 1000 times too
        // large.
        writer.ChangeWriter().Model()->SetWriteLengthUnit(unit->millimetres);
        if (!writer.Transfer(document, STEPControl_AsIs)) throw Standard_Failure("the shapes are not taken");
        const Handle(StepData_StepModel) model = writer.ChangeWriter().Model();
        set_header(model, title);
        StepData_StepWriter text(model);
        text.FloatWriter().SetFormat("%.16E");  // all digits
        text.SendModel(Handle(StepData_Protocol)::DownCast(model->Protocol()));
        Pieces pieces(append, to);
        std::ostream out(&pieces);
        const bool printed = text.Print(out) && out.good();
        document->Close();
        return printed || fail("the file is not complete", message);
    } catch (const Standard_Failure& failure) {
        *shape = made;
        if (!document.IsNull()) document->Close();
        return fail(failure.GetMessageString(), message);
    } catch (const std::exception& failure) {
        return fail(failure.what(), message);
    }
}

}  // namespace
}  // namespace pcm

extern "C" __attribute__((visibility("default"))) const void* pcm_step_functions()
{
    static constexpr pcm::StepFunctions functions{pcm::step_module_version, pcm::write};
    return &functions;
}
