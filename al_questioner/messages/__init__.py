"""Conversion of domain objects to JSON documents, point clouds and images; the caller passes the message classes."""
