"""Diagnosis of an arm: several joints that share the inertial parameters of its links.

Each joint is diagnosed as a separate body, with the information of the other joints on the links
(`shared_links`). Effects that are accepted at one joint improve this information.
"""
