"""HTTP tools for the routes: bodies, plan formats, problem documents and the OpenAPI document."""
