// What OpenCASCADE reads in a STEP file: a line of JSON for each shape.
//
//     step_facts FILE UNIT      lengths in this unit, in millimetres: 1000
//
// "name", "form" (solid, face), "valid", "colour" (0 to 255), "measure" (a solid's volume, a face's area), "surface"
// with the numbers of its first curved face, or of its only one: "kind", "place", "axis", "radius", "second".
#include <BRepAdaptor_Surface.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Controller.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <iostream>

namespace {

using Json = nlohmann::json;

Json numbers(const gp_XYZ& v) { return {v.X(), v.Y(), v.Z()}; }

Json facts(const char* kind, const gp_Pnt& place, const gp_Dir& axis, double radius, double second)
{
    return {{"kind", kind},
            {"place", numbers(place.XYZ())},
            {"axis", numbers(axis.XYZ())},
            {"radius", radius},
            {"second", second}};
}

Json surface_of(const TopoDS_Shape& shape)
{
    Json flat;
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
        const BRepAdaptor_Surface s(TopoDS::Face(face.Current()));
        switch (s.GetType()) {
            case GeomAbs_Plane:
                flat = facts("plane", s.Plane().Location(), s.Plane().Axis().Direction(), 0, 0);
                break;
            case GeomAbs_Cylinder:
                return facts("cylinder", s.Cylinder().Location(), s.Cylinder().Axis().Direction(),
                             s.Cylinder().Radius(), 0);
            case GeomAbs_Cone:
                return facts("cone", s.Cone().Apex(), s.Cone().Axis().Direction(), 0, s.Cone().SemiAngle());
            case GeomAbs_Sphere:
                return facts("sphere", s.Sphere().Location(), s.Sphere().Position().Direction(), s.Sphere().Radius(),
                             0);
            case GeomAbs_Torus:
                return facts("torus", s.Torus().Location(), s.Torus().Axis().Direction(), s.Torus().MajorRadius(),
                             s.Torus().MinorRadius());
            default:
                return {{"kind", "other"}};
        }
    }
    return flat;
}

// Relative to a place within the shape: far from the origin digits would be lost.
double measure_of(const TopoDS_Shape& shape)
{
    const TopExp_Explorer vertex(shape, TopAbs_VERTEX);
    GProp_GProps properties(BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current())));
    if (shape.ShapeType() == TopAbs_SOLID)
        BRepGProp::VolumeProperties(shape, properties, 1e-12);
    else
        BRepGProp::SurfaceProperties(shape, properties);
    return properties.Mass();
}

Json colour_of(const Handle(XCAFDoc_ColorTool) & colours, const TDF_Label& label, const TopoDS_Shape& shape)
{
    Quantity_Color colour;
    if (!colours->GetColor(label, XCAFDoc_ColorSurf, colour) && !colours->GetColor(shape, XCAFDoc_ColorSurf, colour) &&
        !colours->GetColor(shape, XCAFDoc_ColorGen, colour))
        return nullptr;
    double r, g, b;
    colour.Values(r, g, b, Quantity_TOC_sRGB);
    return {std::lround(r * 255), std::lround(g * 255), std::lround(b * 255)};
}

}  // namespace

int main(int count, char** arguments)
{
    if (count != 3) return 2;
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
    STEPControl_Controller::Init();
    STEPCAFControl_Reader reader;
    reader.SetColorMode(true);
    reader.SetNameMode(true);
    if (reader.ReadFile(arguments[1]) != IFSelect_RetDone) return 1;
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    XCAFDoc_DocumentTool::SetLengthUnit(document, std::atof(arguments[2]), UnitsMethods_LengthUnit_Millimeter);
    if (!reader.Transfer(document)) return 1;
    const Handle(XCAFDoc_ShapeTool) tree = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
    TDF_LabelSequence labels;
    tree->GetFreeShapes(labels);
    for (int i = 1; i <= labels.Length(); ++i) {
        const TDF_Label label = labels.Value(i);
        TopoDS_Shape shape = tree->GetShape(label);
        Handle(TDataStd_Name) name;
        std::string text;
        if (label.FindAttribute(TDataStd_Name::GetID(), name)) {
            text.resize(static_cast<std::size_t>(name->Get().LengthOfCString()) + 1);
            char* bytes = text.data();
            text.resize(static_cast<std::size_t>(name->Get().ToUTF8CString(bytes)));
        }
        const bool valid = BRepCheck_Analyzer(shape).IsValid();
        Json colour = colour_of(colours, label, shape);
        // A face is read in a shell, and may be in a compound.
        const TopExp_Explorer body(shape, TopAbs_SOLID), face(shape, TopAbs_FACE);
        shape = body.More() ? body.Current() : face.Current();
        if (colour.is_null()) colour = colour_of(colours, label, shape);
        const char* form = shape.ShapeType() == TopAbs_SOLID  ? "solid"
                           : shape.ShapeType() == TopAbs_FACE ? "face"
                                                              : "other";
        std::cout << Json{{"name", text},
                          {"form", form},
                          {"valid", valid},
                          {"colour", colour},
                          {"measure", measure_of(shape)},
                          {"surface", surface_of(shape)}}
                         .dump()
                  << '\n';
    }
    return 0;
}
