#pragma once

// Small 3MF files, made by the tests that read them.

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/bytes/zip.h"

namespace crumple::test {

/// Names and contents of the files (parts) in a 3MF package. The part "_rels/.rels" names the part that has the model.
struct PackageParts : std::vector<std::pair<std::string, std::string>> {
    using vector::vector;

    std::string bytes(io::ZipWriter::Method method = io::ZipWriter::Method::deflate) const {
        io::ZipWriter archive("3MF");
        for (const auto& [name, text] : *this) {
            archive.begin(name, method, text.size());
            archive.add(text);
            archive.end();
        }
        std::ostringstream out;
        archive.write(out);
        return out.str();
    }
};

inline const std::string relationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
 <Relationship Target="/3D/3dmodel.model" Id="r0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
 <Relationship Target="/a.png" Id="r1" Type="http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"/>
</Relationships>
)";

/// Returns the XML of a model part: a root element with extra `attributes` around `children`. The first child is in
/// line 3, so that tests know the line numbers in messages.
inline std::string model_around(const std::string& children, const std::string& attributes = "") {
    return "<?xml version=\"1.0\"?>\n<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
           "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" " +
           attributes + ">\n" + children + "</model>\n";
}

/// A tetrahedron as the mesh of an object.
inline const std::string tetrahedron =
    R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>
<vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
<triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh>)";

inline std::string file_3mf(const std::string& model) {
    return PackageParts{{"_rels/.rels", relationships}, {"3D/3dmodel.model", model}}.bytes();
}

}  // namespace crumple::test
