"""XML namespaces, and names of package entries, that reading and writing 3MF files share."""

NAMESPACE = "http://schemas.amprep.dev/3mf/2026/11"
"""Namespace of all metadata that amprep reads from jobs and writes into builds."""

CORE_NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
BEAM_NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
CURA_NAMESPACE = "http://software.ultimaker.com/xml/cura/3mf/2015/10"
PRUSASLICER_NAMESPACE = "http://schemas.slic3r.org/3mf/2017/06"

MODEL_NAME = "3D/3dmodel.model"
ROOT_RELATIONSHIPS = "_rels/.rels"
PRUSASLICER_CONFIG = "Metadata/Slic3r_PE_model.config"
BAMBU_CONFIG = "Metadata/model_settings.config"
"""Configuration entry of Bambu Studio and OrcaSlicer."""
